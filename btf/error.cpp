// Builds the sentence of an Error.

#include "btf/error.h"

#include <system_error>
#include <utility>

namespace weft {

namespace {

std::string sentence(const std::string& where, const std::string& what, const std::string& hint) {
  std::string text = where.empty() ? what : where + ": " + what;
  if (!hint.empty()) text += " (" + hint + ")";
  return text;
}

}  // namespace

Error::Error(Kind kind, std::string where, std::string what, std::string hint)
    : std::runtime_error(sentence(where, what, hint)), kind_(kind), where_(std::move(where)) {}

Error bad_input(std::string where, std::string what, std::string hint) {
  return {Error::Kind::bad_input, std::move(where), std::move(what), std::move(hint)};
}

Error failed(std::string where, std::string what, std::string hint) {
  return {Error::Kind::failed, std::move(where), std::move(what), std::move(hint)};
}

std::string system_reason(int error_number) {
  return std::generic_category().message(error_number);
}

}  // namespace weft
