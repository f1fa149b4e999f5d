#include "acquisition/mesostructures/stone_bed.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace weft {

namespace {

double cross(const Vec3& a, const Vec3& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

}  // namespace

StoneBed::Footprint StoneBed::footprint(const TriangleMesh& body) const {
  std::map<std::pair<int, int>, std::pair<float, float>> cells;
  const auto cell_after = [this](float v) {
    return static_cast<int>(std::ceil(v * static_cast<float>(size_)));
  };
  for (const auto& t : body.triangles) {
    const Vec3& a = body.positions[t[0]];
    const Vec3& b = body.positions[t[1]];
    const Vec3& c = body.positions[t[2]];
    const double area = cross(a, b, c.x, c.y);
    if (area == 0) continue;
    for (int j = cell_after(std::min({a.y, b.y, c.y})); j < cell_after(std::max({a.y, b.y, c.y}));
         ++j) {
      for (int i = cell_after(std::min({a.x, b.x, c.x})); i < cell_after(std::max({a.x, b.x, c.x}));
           ++i) {
        const double x = static_cast<double>(i) / size_;
        const double y = static_cast<double>(j) / size_;
        const double of_a = cross(b, c, x, y) / area;
        const double of_b = cross(c, a, x, y) / area;
        if (of_a < 0 || of_b < 0 || of_a + of_b > 1) continue;
        const auto z = static_cast<float>(of_a * a.z + of_b * b.z + (1 - of_a - of_b) * c.z);
        const auto [found, added] = cells.try_emplace({j, i}, z, z);
        found->second.first = std::min(found->second.first, z);
        found->second.second = std::max(found->second.second, z);
      }
    }
  }
  Footprint result;
  for (const auto& [place, range] : cells)
    result.cells.push_back({place.second, place.first, range.first, range.second});
  return result;
}

std::size_t StoneBed::index(int x, int y) const {
  const auto wrapped = [this](int cell) {
    return static_cast<std::size_t>((cell % size_ + size_) % size_);
  };
  return wrapped(y) * static_cast<std::size_t>(size_) + wrapped(x);
}

float StoneBed::rest(const Footprint& body, int x, int y) const {
  float height = 0;
  bool first = true;
  for (const Footprint::Cell& cell : body.cells) {
    const float needed = heights_[index(x + cell.x, y + cell.y)] - cell.lower;
    height = first ? needed : std::max(height, needed);
    first = false;
  }
  return height;
}

void StoneBed::lay(const Footprint& body, int x, int y, float height) {
  for (const Footprint::Cell& cell : body.cells) {
    float& top = heights_[index(x + cell.x, y + cell.y)];
    top = std::max(top, height + cell.upper);
  }
}

}  // namespace weft
