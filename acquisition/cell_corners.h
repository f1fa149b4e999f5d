// Which cells touch: numbers for the corners that they share.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "acquisition/facet_cells.h"

namespace weft {

/// Numbers for places of the endless surface, from 0 on; what is the same place to 1e-6 tiles, in
/// whatever copy of the tile, has one number.
class PlaceNumbers {
 public:
  /// @param places  about how many different ones will come.
  explicit PlaceNumbers(std::size_t places = 0);

  /// The place's number, a new one where it has none yet.
  std::uint32_t number(const Vec3& point);
  /// None where it has none yet.
  std::optional<std::uint32_t> find(const Vec3& point) const;
  /// For a place that nobody will ask for again.
  std::uint32_t unshared() { return count_++; }
  std::uint32_t count() const { return count_; }

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint32_t number = none;
  };
  static constexpr std::uint32_t none = 0xFFFFFFFF;

  // Where the key is, or the free entry where it belongs.
  std::size_t entry_of(std::uint64_t key) const;
  void grow();

  // Open addressing, as one miss of the cache a place is what numbering costs: a power of two of
  // entries, at most half of them taken.
  std::vector<Entry> entries_;
  std::size_t taken_ = 0;
  std::uint32_t count_ = 0;
};

struct CellCorners {
  std::vector<std::array<std::uint32_t, 3>> of_cell;
  std::size_t count = 0;  ///< of different corners
};

/// Of the side * side cells that each of `wholes` is cut into, whole by whole, in the order of
/// `enter`.
/// @param side     1 to 4.
/// @param numbers  gets the places.
CellCorners cell_corners(const std::vector<Facet>& facets, std::span<const Cell> wholes, int side,
                         PlaceNumbers& numbers);

/// The 3 * side points at which the cells that `whole` is cut into touch its rim.
std::vector<Vec3> rim_of(const Facet& facet, const Cell& whole, int side);

}  // namespace weft
