#include "settings/nearest_name.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>

namespace weft {

namespace {

/// Letters to insert, delete or replace (Levenshtein), or neighbours to swap, to turn `a` into `b`.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replace, above[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    std::swap(before, above);
    std::swap(above, row);
  }
  return above[b.size()];
}

}  // namespace

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t least = 0;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    const std::size_t longest = std::max(name.size(), candidate.size());
    if (distance > std::max<std::size_t>(2, longest / 3) || distance >= longest) continue;
    if (nearest.empty() || distance < least) {
      nearest = candidate;
      least = distance;
    }
  }
  return nearest;
}

std::string name_hint(const std::string& name, const std::vector<std::string>& candidates) {
  if (candidates.empty()) return "no name is valid here";
  const std::string nearest = nearest_name(name, candidates);
  const std::string valid = fmt::format("valid here: {}", fmt::join(candidates, ", "));
  return nearest.empty() ? valid : fmt::format("did you mean '{}'? {}", nearest, valid);
}

}  // namespace weft
