#include "cli/memory_option.h"

namespace weft::cli {

void add_memory_option(CLI::App& command, std::uint64_t& bytes, const std::string& description) {
  command.add_option("--memory", bytes, description)
      ->transform(CLI::AsSizeValue(false))
      // Runs before the one above, which would take -1 for the largest number there is.
      ->transform(CLI::Validator(
          [](const std::string& text) {
            return text.starts_with('-') ? "is " + text + "; expected 0 or more" : std::string();
          },
          ""));
}

}  // namespace weft::cli
