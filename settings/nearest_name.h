// What a mistyped name was meant to be: for errors that list the valid ones.
#pragma once

#include <string>
#include <vector>

namespace weft {

/// The candidate with the smallest edit distance to `name` (the first of equals), or an empty
/// string where even that differs in more than a third of its letters (at least two).
std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates);

/// "did you mean 'NEAREST'? valid here: a, b, c", without the question where nothing is near.
std::string name_hint(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace weft
