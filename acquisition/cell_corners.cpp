#include "acquisition/cell_corners.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "btf/random.h"

namespace weft {

namespace {

constexpr int most_side = 4;

std::uint64_t key_of(const Vec3& point) {
  constexpr double steps = 1e6;  // a tile
  const auto wrapped = [&](float x) {
    return std::llround((x - std::floor(x)) * steps) % static_cast<std::int64_t>(steps);
  };
  return hash_coordinates(wrapped(point.x), wrapped(point.y), std::llround(point.z * steps));
}

Vec3 place_on(const Facet& facet, const Cell& whole, int i, int j, int side) {
  const auto [u, v] = point_of(whole, static_cast<float>(i) / static_cast<float>(side),
                               static_cast<float>(j) / static_cast<float>(side));
  return facet.point(u, v);
}

}  // namespace

PlaceNumbers::PlaceNumbers(std::size_t places)
    : entries_(std::bit_ceil(std::max<std::size_t>(2 * places, 16))) {}

// Keys are hashes: their low bits are as good as any.
std::size_t PlaceNumbers::entry_of(std::uint64_t key) const {
  std::size_t at = key & (entries_.size() - 1);
  while (entries_[at].number != none && entries_[at].key != key)
    at = (at + 1) & (entries_.size() - 1);
  return at;
}

void PlaceNumbers::grow() {
  const std::vector<Entry> old = std::exchange(entries_, std::vector<Entry>(2 * entries_.size()));
  for (const Entry& entry : old) {
    if (entry.number != none) entries_[entry_of(entry.key)] = entry;
  }
}

std::uint32_t PlaceNumbers::number(const Vec3& point) {
  const std::uint64_t key = key_of(point);
  const Entry& found = entries_[entry_of(key)];
  if (found.number != none) return found.number;
  if (2 * ++taken_ > entries_.size()) grow();
  entries_[entry_of(key)] = {.key = key, .number = count_};
  return count_++;
}

std::optional<std::uint32_t> PlaceNumbers::find(const Vec3& point) const {
  const Entry& found = entries_[entry_of(key_of(point))];
  if (found.number == none) return std::nullopt;
  return found.number;
}

CellCorners cell_corners(const std::vector<Facet>& facets, std::span<const Cell> wholes, int side,
                         PlaceNumbers& numbers) {
  CellCorners corners;
  corners.of_cell.reserve(wholes.size() * static_cast<std::size_t>(side) * side);
  std::array<std::array<std::uint32_t, most_side + 1>, most_side + 1> number{};
  for (const Cell& whole : wholes) {
    for (int i = 0; i <= side; ++i) {
      for (int j = 0; i + j <= side; ++j) {
        const bool on_rim = i == 0 || j == 0 || i + j == side;
        number[i][j] = on_rim ? numbers.number(place_on(facets[whole.facet], whole, i, j, side))
                              : numbers.unshared();
      }
    }
    for_each_cell(side, [&](const auto& p, const auto& q, const auto& r) {
      corners.of_cell.push_back({number[p[0]][p[1]], number[q[0]][q[1]], number[r[0]][r[1]]});
    });
  }
  corners.count = numbers.count();
  return corners;
}

std::vector<Vec3> rim_of(const Facet& facet, const Cell& whole, int side) {
  std::vector<Vec3> rim;
  for (int i = 0; i < side; ++i) {
    rim.push_back(place_on(facet, whole, i, 0, side));
    rim.push_back(place_on(facet, whole, side - i, i, side));
    rim.push_back(place_on(facet, whole, 0, side - i, side));
  }
  return rim;
}

}  // namespace weft
