// The one exception type of the project: where it went wrong, what was found, what would help.
#pragma once

#include <stdexcept>
#include <string>

namespace weft {

/// Thrown for every failure. `what()` is one sentence: "WHERE: WHAT (HINT)".
class Error : public std::runtime_error {
 public:
  /// Decides the exit code of the program: `failed` 1 (disk full, no display), `bad_input` 2.
  enum class Kind { failed, bad_input };

  /// @param where  file, file:line:column, or the name of a field or option; may be empty.
  /// @param what   what was found and what was expected.
  /// @param hint   what the user may do about it; may be empty.
  Error(Kind kind, std::string where, std::string what, std::string hint = {});

  Kind kind() const { return kind_; }
  const std::string& where() const { return where_; }

 private:
  Kind kind_;
  std::string where_;
};

/// Bad input: a file, a field or an option that the user can mend.
Error bad_input(std::string where, std::string what, std::string hint = {});
/// Something outside failed: a disk, a display.
Error failed(std::string where, std::string what, std::string hint = {});
/// What the system calls a value of errno, e.g. "No space left on device".
std::string system_reason(int error_number);

}  // namespace weft
