#include "acquisition/surrounding_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tracer/frame.h"

namespace weft {

namespace {

// So many are those right around the direction and some of the next, so that whatever stands up
// between two of them would most likely hide a third.
constexpr std::size_t count = 8;
constexpr float farthest = radians(40.0F);
constexpr double widest_gap = radians(150.0);

// A point of the square [-1, 1]^2 as a direction (the upper half of an octahedron, turned by 45
// degrees).
Direction direction_at(float a, float b) {
  const float u = (a + b) / 2;
  const float v = (a - b) / 2;
  return Direction(u, v, 1 - std::abs(u) - std::abs(v)).normalized();
}

// Whether the lights leave no wide gap, seen from the direction. One right there is on no side.
bool surround(const LightSet& lights, std::span<const std::uint32_t> chosen,
              const Direction& direction) {
  constexpr float right_there = 1e-4F;
  const Frame frame = frame_around(direction);
  std::vector<double> angles;
  for (const std::uint32_t l : chosen) {
    const Vec3 local = frame.to_local(lights[l]);
    if (std::hypot(local.x, local.y) > right_there) angles.push_back(std::atan2(local.y, local.x));
  }
  if (angles.empty()) return false;
  std::ranges::sort(angles);
  double gap = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap < widest_gap;
}

}  // namespace

std::size_t SurroundingLights::bin_of(const Direction& direction) {
  const float scale = 1 / (std::abs(direction.x) + std::abs(direction.y) + direction.z);
  const float u = direction.x * scale;
  const float v = direction.y * scale;
  const auto bin = [](float a) {
    return std::clamp(static_cast<int>((a + 1) * (side / 2.0F)), 0, side - 1);
  };
  return static_cast<std::size_t>(bin(u + v) * side + bin(u - v));
}

SurroundingLights::SurroundingLights(const LightSet& lights) : first_{0} {
  if (lights.size() < count) return;
  std::vector<std::uint32_t> nearest(lights.size());
  std::iota(nearest.begin(), nearest.end(), 0U);
  const auto end = nearest.begin() + count;
  const std::span<const std::uint32_t> chosen(nearest.begin(), end);
  const auto edge = [](int i) { return static_cast<float>(i) * (2.0F / side) - 1; };
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const Direction centre =
          direction_at((edge(row) + edge(row + 1)) / 2, (edge(column) + edge(column + 1)) / 2);
      std::partial_sort(nearest.begin(), end, nearest.end(), [&](auto a, auto b) {
        const float near_a = lights[a] ^ centre;
        const float near_b = lights[b] ^ centre;
        return near_a != near_b ? near_a > near_b : a < b;
      });
      const std::array<Direction, 4> corners = {
          direction_at(edge(row), edge(column)), direction_at(edge(row), edge(column + 1)),
          direction_at(edge(row + 1), edge(column)), direction_at(edge(row + 1), edge(column + 1))};
      const bool on_all_sides = std::ranges::all_of(
          corners, [&](const Direction& corner) { return surround(lights, chosen, corner); });
      if (on_all_sides && (lights[chosen.back()] ^ centre) > std::cos(farthest)) add_bin(chosen);
      first_.push_back(static_cast<std::uint32_t>(parts_.size()));
    }
  }
}

void SurroundingLights::add_bin(std::span<const std::uint32_t> lights) {
  std::vector<std::uint32_t> sorted(lights.begin(), lights.end());
  std::ranges::sort(sorted);
  for (const std::uint32_t l : sorted) {
    const std::uint32_t group = l / lanes;
    if (parts_.size() == first_.back() || parts_.back().group != group)
      parts_.push_back({group, 0});
    parts_.back().lights |= static_cast<std::uint16_t>(1U << (l % lanes));
  }
}

}  // namespace weft
