// Parsing `--btf` and opening what it names.

#include "cli/btf_option.h"

#include <map>
#include <memory>

#include "btf/error.h"
#include "codecs/representation.h"

namespace weft::cli {

BtfOption parse_btf_option(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || std::filesystem::exists(text)) return {"", text};
  const BtfOption option{text.substr(0, equals), text.substr(equals + 1)};
  if (option.material.empty() || option.path.empty()) {
    throw bad_input("--btf", "'" + text + "' is neither PATH nor MATERIAL=PATH");
  }
  return option;
}

OpenAppearance open_datasets() {
  auto opened =
      std::make_shared<std::map<std::filesystem::path, std::shared_ptr<const Appearance>>>();
  return [opened](const std::filesystem::path& path) {
    std::error_code missing;
    auto key = std::filesystem::canonical(path, missing);
    std::shared_ptr<const Appearance>& appearance = (*opened)[missing ? path : key];
    if (!appearance) appearance = open_representation(path);
    return appearance;
  };
}

}  // namespace weft::cli
