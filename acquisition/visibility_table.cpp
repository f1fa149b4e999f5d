#include "acquisition/visibility_table.h"

#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cmath>
#include <unordered_map>

#include "btf/random.h"

namespace weft {

namespace {

constexpr float cell_size = 1.0F / 96;  // tiles; longest edge of a cell
constexpr int most_cells_a_side = 128;
constexpr std::size_t cells_at_once = lanes;  // a packet of rays

struct Place {
  std::uint32_t facet;
  std::uint16_t row;       // along u
  std::uint16_t position;  // 2 * column along v, + 1 for the cell that points the other way
};

int cells_a_side(const Facet& facet) {
  if (facet.degenerate()) return 1;
  const float longest = std::max(
      {facet.edge_u.length(), facet.edge_v.length(), (facet.edge_u - facet.edge_v).length()});
  return std::clamp(static_cast<int>(std::ceil(longest / cell_size)), 1, most_cells_a_side);
}

using Barycentric = std::array<float, 2>;

std::array<Barycentric, 3> corners_of(const Place& place, int side) {
  const auto at = [&](int i, int j) {
    return Barycentric{static_cast<float>(i) / static_cast<float>(side),
                       static_cast<float>(j) / static_cast<float>(side)};
  };
  const int i = place.row;
  const int j = place.position / 2;
  if (place.position % 2 == 0) return {at(i, j), at(i + 1, j), at(i, j + 1)};
  return {at(i + 1, j + 1), at(i, j + 1), at(i + 1, j)};
}

// The middle, and points near the corners.
Barycentric point_of(const std::array<Barycentric, 3>& corners, int k) {
  std::array<float, 3> weight{1.0F / 3, 1.0F / 3, 1.0F / 3};
  if (k > 0) {
    weight.fill(0.05F);
    weight[k - 1] = 0.9F;
  }
  Barycentric point{0, 0};
  for (int c = 0; c < 3; ++c) {
    for (int axis = 0; axis < 2; ++axis) point[axis] += weight[c] * corners[c][axis];
  }
  return point;
}

// One number for what is the same place of the endless surface, to 1e-6 tiles.
std::uint64_t key_of(const Vec3& p) {
  constexpr double steps = 1e6;
  const auto wrapped = [&](float x) {
    return std::llround((x - std::floor(x)) * steps) % static_cast<std::int64_t>(steps);
  };
  return hash_coordinates(wrapped(p.x), wrapped(p.y), std::llround(p.z * steps));
}

}  // namespace

std::size_t VisibilityTable::cells_of(const std::vector<Facet>& facets) {
  std::size_t cells = 0;
  for (const Facet& facet : facets) {
    const int side = cells_a_side(facet);
    cells += static_cast<std::size_t>(side) * side;
  }
  return cells;
}

VisibilityTable::VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights)
    : groups_(lights.groups()), cells_(facets.size()), answers_(groups_) {
  for (std::size_t g = 0; g < groups_; ++g)
    answers_[g].known = static_cast<std::uint16_t>(~lights.used_lanes(g));
}

VisibilityTable::VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights,
                                 const PeriodicScene& scene, int rays_a_cell)
    : VisibilityTable(facets, lights) {
  const std::vector<Answer> nothing = std::move(answers_);
  std::uint32_t count = 0;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    const int side = cells_a_side(facets[f]);
    cells_[f] = {count, static_cast<std::uint16_t>(side)};
    count += static_cast<std::uint32_t>(side * side);
  }
  answers_.assign(count * groups_, {});
  ask(facets, lights, scene, rays_a_cell);
  agree(facets, lights);
  answers_.insert(answers_.end(), nothing.begin(), nothing.end());
}

namespace {

// Every cell of every facet, in the order of their numbers.
template <typename Cells>
std::vector<Place> places_of(const std::vector<Cells>& cells) {
  std::vector<Place> places;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    for (int i = 0; i < cells[f].side; ++i) {
      for (int p = 0; p < 2 * (cells[f].side - i) - 1; ++p) {
        places.push_back({static_cast<std::uint32_t>(f), static_cast<std::uint16_t>(i),
                          static_cast<std::uint16_t>(p)});
      }
    }
  }
  return places;
}

}  // namespace

// Until `agree`, `visible` holds the lights that some point of the cell sees, and `known` those
// that some point does not see.
void VisibilityTable::ask(const std::vector<Facet>& facets, const LightSet& lights,
                          const PeriodicScene& scene, int rays_a_cell) {
  const std::vector<Place> places = places_of(cells_);
  std::atomic<std::int64_t> rays = 0;
  const auto ask_chunk = [&](std::size_t chunk) {
    const std::size_t first = chunk * cells_at_once;
    const std::size_t count = std::min(cells_at_once, places.size() - first);
    std::int64_t traced = 0;
    for (int k = 0; k < rays_a_cell; ++k) {
      std::array<Vec3, cells_at_once> origins;
      Vec3Lanes normals{};
      for (std::size_t i = 0; i < count; ++i) {
        const Place& place = places[first + i];
        const Facet& facet = facets[place.facet];
        const auto [u, v] = point_of(corners_of(place, cells_[place.facet].side), k);
        origins[i] = ray_origin(facet.point(u, v), facet.normal);
        normals.x[i] = facet.normal.x;
        normals.y[i] = facet.normal.y;
        normals.z[i] = facet.normal.z;
      }
      for (std::size_t l = 0; l < lights.size(); ++l) {
        const std::uint16_t facing = bits_of_lanes(dot(lights[l], normals) > 0);
        if (facing == 0) continue;
        RayPacket packet{};
        for (std::size_t i = 0; i < cells_at_once; ++i)
          packet.set(i, i < count ? origins[i] : Vec3(0, 0, 0), lights[l]);
        scene.occluded(packet, facing, Coherence::coherent);
        const std::uint16_t hidden = facing & bits_of_lanes(packet.tfar < 0);
        const auto bit = static_cast<std::uint16_t>(1U << (l % lanes));
        for (std::size_t i = 0; i < count; ++i) {
          if ((facing >> i & 1U) == 0) continue;
          Answer& answer = answers_[(first + i) * groups_ + l / lanes];
          ((hidden >> i & 1U) != 0 ? answer.known : answer.visible) |= bit;
          ++traced;
        }
      }
    }
    rays += traced;
  };
  tbb::parallel_for(std::size_t{0}, (places.size() + cells_at_once - 1) / cells_at_once, ask_chunk);
  rays_ = rays;
}

// Certain is what all points of a cell and of the cells that touch it agree on.
void VisibilityTable::agree(const std::vector<Facet>& facets, const LightSet& lights) {
  const std::vector<Place> places = places_of(cells_);
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  std::vector<std::array<std::uint32_t, 3>> corners(places.size());
  for (std::size_t c = 0; c < places.size(); ++c) {
    const Facet& facet = facets[places[c].facet];
    const auto at = corners_of(places[c], cells_[places[c].facet].side);
    for (int k = 0; k < 3; ++k) {
      const auto next = static_cast<std::uint32_t>(numbers.size());
      corners[c][k] =
          numbers.try_emplace(key_of(facet.point(at[k][0], at[k][1])), next).first->second;
    }
  }
  std::vector<std::uint16_t> some_see(numbers.size() * groups_);
  std::vector<std::uint16_t> some_do_not(numbers.size() * groups_);
  for (std::size_t c = 0; c < places.size(); ++c) {
    for (const std::uint32_t corner : corners[c]) {
      for (std::size_t g = 0; g < groups_; ++g) {
        some_see[corner * groups_ + g] |= answers_[c * groups_ + g].visible;
        some_do_not[corner * groups_ + g] |= answers_[c * groups_ + g].known;
      }
    }
  }
  for (std::size_t c = 0; c < places.size(); ++c) {
    for (std::size_t g = 0; g < groups_; ++g) {
      Answer& answer = answers_[c * groups_ + g];
      std::uint16_t seen = 0;
      std::uint16_t hidden = 0;
      for (const std::uint32_t corner : corners[c]) {
        seen |= some_see[corner * groups_ + g];
        hidden |= some_do_not[corner * groups_ + g];
      }
      const auto visible = static_cast<std::uint16_t>(answer.visible & ~hidden);
      const auto blocked = static_cast<std::uint16_t>(answer.known & ~seen);
      answer.visible = visible;
      answer.known = static_cast<std::uint16_t>(visible | blocked | ~lights.used_lanes(g));
    }
  }
}

std::size_t VisibilityTable::cell(std::uint32_t facet, float u, float v) const {
  const Cells& cells = cells_[facet];
  if (cells.side == 1) return cells.first;
  const auto side = static_cast<float>(cells.side);
  const int i = std::clamp(static_cast<int>(u * side), 0, cells.side - 1);
  const int most = 2 * (cells.side - i) - 2;  // of the row's positions
  const int j = static_cast<int>(v * side);
  const bool other = u * side - static_cast<float>(i) + v * side - static_cast<float>(j) > 1;
  const int position = std::clamp(2 * j + (other ? 1 : 0), 0, most);
  return cells.first + static_cast<std::size_t>(i * (2 * cells.side - i) + position);
}

std::size_t VisibilityTable::bytes() const {
  return cells_.size() * sizeof(Cells) + answers_.size() * sizeof(Answer);
}

}  // namespace weft
