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

// A random point of a cell; four in a row lie in its four quarters.
Barycentric point_of(const std::array<Barycentric, 3>& corners, std::size_t cell, int round) {
  const std::uint64_t bits = hash_coordinates(cell, round);
  std::array<float, 2> at{unit_float(bits), unit_float(bits << 32)};
  if (at[0] + at[1] > 1) at = {1 - at[0], 1 - at[1]};
  std::array<float, 3> weight{1 - at[0] - at[1], at[0], at[1]};
  // Quarters: the one in the middle is turned round, the others touch a corner.
  const int quarter = round % 4;
  for (int c = 0; c < 3; ++c) {
    weight[c] = quarter == 0 ? (1 - weight[c]) / 2 : (weight[c] + (c == quarter - 1 ? 1 : 0)) / 2;
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

// Asks round after round, and says what is certain so far.
class Inquiry {
 public:
  using Answer = VisibilityTable::Answer;

  Inquiry(const std::vector<Facet>& facets, const LightSet& lights, const PeriodicScene& scene,
          std::vector<Place> places, std::vector<std::array<std::uint32_t, 3>> corners,
          std::size_t corner_count, const std::vector<int>& sides)
      : facets_(facets),
        lights_(lights),
        scene_(scene),
        places_(std::move(places)),
        corners_(std::move(corners)),
        corner_count_(corner_count),
        sides_(sides),
        groups_(lights.groups()),
        seen_(places_.size() * groups_),
        hidden_(seen_.size()) {}

  struct Round {
    std::int64_t rays = 0;
    std::int64_t certain = 0;       // of them, those whose answer was certain before
    std::int64_t contradicted = 0;  // of those
  };

  // One ray from each cell to each light in front of it.
  Round ask(int round, const std::vector<Answer>& answers) {
    std::atomic<std::int64_t> rays = 0;
    std::atomic<std::int64_t> certain = 0;
    std::atomic<std::int64_t> contradicted = 0;
    const std::size_t chunks = (places_.size() + cells_at_once - 1) / cells_at_once;
    tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
      const Round r = ask_chunk(chunk * cells_at_once, round, answers);
      rays += r.rays;
      certain += r.certain;
      contradicted += r.contradicted;
    });
    return {rays, certain, contradicted};
  }

  // Certain is what all points of a cell and of the cells that touch it agree on.
  void agree(std::vector<Answer>& answers) const {
    std::vector<std::uint16_t> some_see(corner_count_ * groups_);
    std::vector<std::uint16_t> some_do_not(corner_count_ * groups_);
    for (std::size_t c = 0; c < places_.size(); ++c) {
      for (const std::uint32_t corner : corners_[c]) {
        for (std::size_t g = 0; g < groups_; ++g) {
          some_see[corner * groups_ + g] |= seen_[c * groups_ + g];
          some_do_not[corner * groups_ + g] |= hidden_[c * groups_ + g];
        }
      }
    }
    for (std::size_t c = 0; c < places_.size(); ++c) {
      for (std::size_t g = 0; g < groups_; ++g) {
        unsigned seen = 0;
        unsigned hidden = 0;
        for (const std::uint32_t corner : corners_[c]) {
          seen |= some_see[corner * groups_ + g];
          hidden |= some_do_not[corner * groups_ + g];
        }
        const unsigned visible = seen_[c * groups_ + g] & ~hidden;
        const unsigned blocked = hidden_[c * groups_ + g] & ~seen;
        const unsigned unused = static_cast<std::uint16_t>(~lights_.used_lanes(g));
        answers[c * groups_ + g] = {static_cast<std::uint16_t>(visible | blocked | unused),
                                    static_cast<std::uint16_t>(visible)};
      }
    }
  }

 private:
  Round ask_chunk(std::size_t first, int round, const std::vector<Answer>& answers) {
    const std::size_t count = std::min(cells_at_once, places_.size() - first);
    std::array<Vec3, cells_at_once> origins{};
    Vec3Lanes normals{};
    for (std::size_t i = 0; i < count; ++i) {
      const Place& place = places_[first + i];
      const Facet& facet = facets_[place.facet];
      const auto [u, v] = point_of(corners_of(place, sides_[place.facet]), first + i, round);
      origins[i] = ray_origin(facet.point(u, v), facet.normal);
      normals.x[i] = facet.normal.x;
      normals.y[i] = facet.normal.y;
      normals.z[i] = facet.normal.z;
    }
    Round result;
    for (std::size_t l = 0; l < lights_.size(); ++l) {
      const std::uint16_t facing = bits_of_lanes(dot(lights_[l], normals) > 0);
      if (facing == 0) continue;
      RayPacket packet{};
      for (std::size_t i = 0; i < cells_at_once; ++i) packet.set(i, origins[i], lights_[l]);
      scene_.occluded(packet, facing, Coherence::coherent);
      const std::uint16_t blocked = bits_of_lanes(packet.tfar < 0);
      const auto bit = static_cast<std::uint16_t>(1U << (l % lanes));
      for (std::size_t i = 0; i < count; ++i) {
        if ((facing >> i & 1U) == 0) continue;
        const std::size_t at = (first + i) * groups_ + l / lanes;
        const bool visible = (blocked >> i & 1U) == 0;
        (visible ? seen_ : hidden_)[at] |= bit;
        ++result.rays;
        if ((answers[at].known & bit) == 0) continue;
        ++result.certain;
        result.contradicted += visible == ((answers[at].visible & bit) != 0) ? 0 : 1;
      }
    }
    return result;
  }

  const std::vector<Facet>& facets_;
  const LightSet& lights_;
  const PeriodicScene& scene_;
  std::vector<Place> places_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::size_t corner_count_;
  const std::vector<int>& sides_;
  std::size_t groups_;
  std::vector<std::uint16_t> seen_;    // [cell][group]: some point sees the light
  std::vector<std::uint16_t> hidden_;  // some point does not
};

// Rays are enough once fewer than this share of them contradict what was certain.
constexpr double rare = 2e-6;

}  // namespace

VisibilityTable::VisibilityTable(const std::vector<Facet>& facets, const LightSet& lights,
                                 const PeriodicScene& scene, int most_rays)
    : VisibilityTable(facets, lights) {
  const std::vector<Answer> nothing = std::move(answers_);
  std::vector<int> sides;
  std::uint32_t count = 0;
  for (std::size_t f = 0; f < facets.size(); ++f) {
    sides.push_back(cells_a_side(facets[f]));
    cells_[f] = {count, static_cast<std::uint16_t>(sides[f])};
    count += static_cast<std::uint32_t>(sides[f] * sides[f]);
  }
  std::vector<Place> places = places_of(cells_);
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  std::vector<std::array<std::uint32_t, 3>> corners(places.size());
  for (std::size_t c = 0; c < places.size(); ++c) {
    const auto at = corners_of(places[c], sides[places[c].facet]);
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = facets[places[c].facet].point(at[k][0], at[k][1]);
      const auto next = static_cast<std::uint32_t>(numbers.size());
      corners[c][k] = numbers.try_emplace(key_of(p), next).first->second;
    }
  }
  Inquiry inquiry(facets, lights, scene, std::move(places), std::move(corners), numbers.size(),
                  sides);
  answers_.assign(count * groups_, {});
  for (int round = 0; round < most_rays; ++round) {
    const Inquiry::Round asked = inquiry.ask(round, answers_);
    rays_ += asked.rays;
    if (round + 1 < least_rays) continue;
    contradicted_ = asked.certain > 0 ? static_cast<double>(asked.contradicted) /
                                            static_cast<double>(asked.certain)
                                      : 0;
    inquiry.agree(answers_);
    if (round + 1 > least_rays && contradicted_ < rare) break;
  }
  answers_.insert(answers_.end(), nothing.begin(), nothing.end());
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
