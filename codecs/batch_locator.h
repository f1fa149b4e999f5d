// The neighbours of sixteen directions among those of a sampling, found side by side.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "btf/hemisphere_sampling.h"

namespace weft {

constexpr std::size_t batch_lanes = 16;

/// One value of each of the sixteen.
template <typename Value>
using Batch = std::array<Value, batch_lanes>;

struct DirectionLanes {
  alignas(64) Batch<float> x;
  alignas(64) Batch<float> y;
  alignas(64) Batch<float> z;
};

/// Three neighbours of each direction and their weights; the fourth place holds index and weight 0.
struct alignas(16) StencilLane {
  std::array<std::int32_t, 4> index;
  std::array<float, 4> weight;
};
using StencilBatch = Batch<StencilLane>;

/// Of one direction.
StencilLane lane_of(const Stencil& stencil);

/// The same stencils as `HemisphereSampling::locate`'s but for rounding, without its branches: the
/// plane is cut into faces, which are the triangles, the strips beyond the hull's edges and the
/// wedges beyond its corners. In each the weights are affine functions of the parabolic image.
class BatchLocator {
 public:
  explicit BatchLocator(const HemisphereSampling& sampling);

  /// @param sampling    that it was made of.
  /// @param directions  sixteen unit vectors, z >= 0.
  StencilBatch locate(const HemisphereSampling& sampling, const DirectionLanes& directions) const;

 private:
  // A point is in the face where its three bounds are not negative; they, held below `most`, are
  // the corners' weights. The fourth places hold zeros.
  struct alignas(16) Face {
    std::array<std::array<float, 4>, 3> bound{};  // [constant, of x, of y][corner]
    std::array<float, 4> most{};
    std::array<std::uint16_t, 4> corner{};
    std::array<std::uint16_t, 4> beyond{};  // the face where that bound is negative
  };
  static Face triangle_face(const HemisphereSampling& sampling, std::size_t triangle);
  void append_hull_faces(const HemisphereSampling& sampling);
  std::uint16_t face_of(std::uint16_t start, float x, float y) const;

  std::vector<Face> faces_;  // empty where directions are asked for one by one
  std::vector<std::uint16_t> grid_;
};

}  // namespace weft
