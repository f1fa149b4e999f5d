// Where directions lie in a factor's parabolic map: one by one, and sixteen side by side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "btf/direction.h"
#include "codecs/stencil_batch.h"
#include "codecs/wide_vector.h"

namespace weft::factor_maps {

/// Where a direction lies in a map: the upper left of its four texels, and how they blend.
struct MapPlace {
  std::int32_t first;  ///< that one's number, row by row
  float across;        ///< 0 at the left, 1 at the right
  float down;          ///< 0 in the upper row, 1 in the lower
};

/// Sixteen points of the parabolic plane.
struct PlaneLanes {
  alignas(64) Batch<float> x;
  alignas(64) Batch<float> y;
};

struct PlaceLanes {
  alignas(64) Batch<std::int32_t> first;
  alignas(64) Batch<float> across;
  alignas(64) Batch<float> down;

  MapPlace lane(std::size_t i) const { return {first[i], across[i], down[i]}; }
};

/// A NaN (the half of opposite directions on the horizon) lies at 0: of std::max, the first stays.
inline PlaceLanes place_lanes(const PlaneLanes& image, int resolution) {
  const auto last = static_cast<float>(resolution - 1);
  PlaceLanes places;
  for (std::size_t i = 0; i < batch_lanes; ++i) {
    const float x = std::min(std::max(0.0F, (image.x[i] + 1) * 0.5F * last), last);
    const float y = std::min(std::max(0.0F, (1 - image.y[i]) * 0.5F * last), last);
    const int column = std::min(static_cast<int>(x), resolution - 2);
    const int row = std::min(static_cast<int>(y), resolution - 2);
    places.first[i] = row * resolution + column;
    places.across[i] = x - static_cast<float>(column);
    places.down[i] = y - static_cast<float>(row);
  }
  return places;
}

/// Four points of the parabolic plane.
struct PlaneQuad {
  Vec4 x;
  Vec4 y;
};

inline std::array<MapPlace, 4> map_places(const PlaneQuad& images, int resolution) {
  using Int4 = std::int32_t __attribute__((vector_size(16)));
  const auto last = static_cast<float>(resolution - 1);
  const Vec4 zero{};
  const auto held = [&](const Vec4& v) {
    const Vec4 above = v > zero ? v : zero;
    return above < last ? above : zero + last;
  };
  const Vec4 x = held((images.x + 1) * 0.5F * last);
  const Vec4 y = held((1 - images.y) * 0.5F * last);
  const Int4 most = Int4{} + (resolution - 2);
  const auto whole = [&](const Vec4& v) {
    const Int4 i = __builtin_convertvector(v, Int4);
    return i < most ? i : most;
  };
  const Int4 column = whole(x);
  const Int4 row = whole(y);
  const Int4 first = row * resolution + column;
  const Vec4 across = x - __builtin_convertvector(column, Vec4);
  const Vec4 down = y - __builtin_convertvector(row, Vec4);
  std::array<MapPlace, 4> places;
  for (int i = 0; i < 4; ++i) places[i] = {first[i], across[i], down[i]};
  return places;
}

/// The parabolic images of light, half-vector, view and difference, of which the last may be left
/// out. The half-vector's is found without normalising it first.
inline PlaneQuad plane_images(const Direction& light, const Direction& view,
                              const Direction& difference = {0, 0, 1}) {
  const Vec3 sum = light + view;
  const Vec4 scale =
      1 / Vec4{1 + light.z, std::sqrt(sum ^ sum) + sum.z, 1 + view.z, 1 + difference.z};
  return {Vec4{light.x, sum.x, view.x, difference.x} * scale,
          Vec4{light.y, sum.y, view.y, difference.y} * scale};
}

}  // namespace weft::factor_maps
