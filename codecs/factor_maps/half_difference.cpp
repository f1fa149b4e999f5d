#include "codecs/factor_maps/half_difference.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace weft::factor_maps {

namespace {

using Row = std::vector<std::pair<std::uint32_t, float>>;

// Centres of the cells of a regular grid over theta in (0, 90) and phi in (0, 360) degrees.
std::vector<Direction> difference_grid(int rings) {
  std::vector<Direction> differences;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      differences.push_back(from_spherical((i + 0.5) * std::numbers::pi / (2 * rings),
                                           (j + 0.5) * std::numbers::pi / rings));
    }
  }
  return differences;
}

void add_pair(Row& row, const Stencil& light, const Stencil& view, std::size_t n_views) {
  for (std::size_t l = 0; l < 3; ++l) {
    for (std::size_t v = 0; v < 3; ++v) {
      const float weight = light.weight[l] * view.weight[v];
      if (weight == 0) continue;
      row.emplace_back(static_cast<std::uint32_t>(light.index[l] * n_views + view.index[v]),
                       weight);
    }
  }
}

Row merged(Row row, int n_pairs) {
  std::ranges::sort(row);
  Row merged;
  for (const auto& [column, weight] : row) {
    if (merged.empty() || merged.back().first != column) merged.emplace_back(column, 0.0F);
    merged.back().second += weight / static_cast<float>(n_pairs);
  }
  return merged;
}

Row average_row(const Direction& half, const std::vector<Direction>& differences,
                const HemisphereSampling& lights, const HemisphereSampling& views) {
  Row row;
  int n_pairs = 0;
  for (const Direction& difference : differences) {
    const DirectionPair pair = pair_of(half, difference);
    if (!(pair.light.z > 0) || !(pair.view.z > 0)) continue;
    add_pair(row, lights.locate(pair.light), views.locate(pair.view), views.size());
    ++n_pairs;
  }
  if (n_pairs == 0) {  // at the very horizon only light = view = half is left
    add_pair(row, lights.locate(half), views.locate(half), views.size());
    n_pairs = 1;
  }
  return merged(std::move(row), n_pairs);
}

// Near the horizon +x and half can be parallel; any tangent serves there.
Vec3 half_tangent(const Direction& half) {
  Vec3 tangent = Vec3(1, 0, 0) - half * half.x;
  if (tangent.length() < 1e-4F) tangent = Vec3(0, 0, 1) - half * half.z;
  return tangent.normalized();
}

}  // namespace

LaneVector multiply(const SparseRows& matrix, const LaneVector& vector) {
  LaneVector result(matrix.start.size() - 1);
  for (std::size_t r = 0; r < result.size(); ++r) {
    Lanes sum;
    for (std::uint32_t e = matrix.start[r]; e < matrix.start[r + 1]; ++e) {
      add_scaled(sum, matrix.weight[e], vector[matrix.column[e]]);
    }
    result[r] = sum;
  }
  return result;
}

DirectionPair pair_of(const Direction& half, const Direction& difference) {
  const Vec3 tangent = half_tangent(half);
  const Vec3 bitangent = half % tangent;
  const Vec3 across = tangent * difference.x + bitangent * difference.y;
  const Vec3 along = half * difference.z;
  return {(along + across).normalized(), (along - across).normalized()};
}

Direction difference_vector(const Direction& light, const Direction& view) {
  const Direction half = half_vector(light, view);
  const Vec3 tangent = half_tangent(half);
  return {light ^ tangent, light ^ (half % tangent), std::max(light ^ half, 0.0F)};
}

SparseRows half_average(const HemisphereSampling& lights, const HemisphereSampling& views,
                        const ParabolicMap& map, int rings) {
  const std::vector<Direction> differences = difference_grid(rings);
  std::vector<Row> rows(static_cast<std::size_t>(map.texels()));
  tbb::parallel_for(0, map.texels(), [&](int texel) {
    rows[texel] = average_row(map.direction(texel), differences, lights, views);
  });
  SparseRows matrix;
  for (const Row& row : rows) {
    for (const auto& [column, weight] : row) {
      matrix.column.push_back(column);
      matrix.weight.push_back(weight);
    }
    matrix.start.push_back(static_cast<std::uint32_t>(matrix.column.size()));
  }
  return matrix;
}

std::vector<BilinearTaps> half_lookup(const HemisphereSampling& lights,
                                      const HemisphereSampling& views, const ParabolicMap& map) {
  std::vector<BilinearTaps> lookup;
  lookup.reserve(lights.size() * views.size());
  for (const Direction& light : lights.directions()) {
    for (const Direction& view : views.directions())
      lookup.push_back(map.taps(half_vector(light, view)));
  }
  return lookup;
}

std::vector<BilinearTaps> difference_lookup(const HemisphereSampling& lights,
                                            const HemisphereSampling& views,
                                            const ParabolicMap& map) {
  std::vector<BilinearTaps> lookup;
  lookup.reserve(lights.size() * views.size());
  for (const Direction& light : lights.directions()) {
    for (const Direction& view : views.directions())
      lookup.push_back(map.taps(difference_vector(light, view)));
  }
  return lookup;
}

LaneVector looked_up(const LaneVector& map, std::span<const BilinearTaps> lookup) {
  LaneVector values(lookup.size());
  for (std::size_t pair = 0; pair < lookup.size(); ++pair) {
    const BilinearTaps& taps = lookup[pair];
    for (std::size_t k = 0; k < 4; ++k)
      add_scaled(values[pair], taps.weight[k], map[taps.index[k]]);
  }
  return values;
}

}  // namespace weft::factor_maps
