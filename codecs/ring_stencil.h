// The four nearest of a sampling's directions that lies in rings, and their bilinear weights in
// (theta, phi) (paper 003, section 5.4).
//
// Two rings around theta, two of each ring's directions around phi. The weights sum to one and are
// continuous: at a ring the other has weight zero, at the pole there is one direction, and beyond
// the last ring theta is held. That needs a direction at the pole, at most 31 rings of three or
// more evenly spaced directions, and `Horizon::hold`; ubo81 and ubo151 are so. Any other sampling
// is answered by its triangulation, three directions and a weight of zero.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/gl_program.h"
#include "codecs/stencil_batch.h"
#include "codecs/wide_vector.h"

namespace weft {

class RingStencil {
 public:
  /// The pole is one of them, and one stays for the last ring's next.
  static constexpr std::size_t most_rings = 32;

  explicit RingStencil(const HemisphereSampling& sampling);

  /// False where the triangulation answers.
  bool has_rings() const { return ring_count_ > 0; }

  /// A NaN gets directions that there are, with whatever weights.
  /// @param sampling    that it was made of.
  /// @param directions  sixteen unit vectors, z >= 0.
  StencilBatch locate(const HemisphereSampling& sampling, const DirectionLanes& directions) const;
  StencilLane locate(const HemisphereSampling& sampling, const Direction& direction) const;

  /// `struct btf_QuadStencil { ivec4 index; vec4 weight; }` and `btf_QuadStencil
  /// PREFIX_locate(vec3 direction)`, with its tables. Needs `direction_stencil_glsl()` before it.
  GlProgram glsl(const HemisphereSampling& sampling, const std::string& prefix) const;

 private:
  // Columns of `most_rings` numbers, so that a look-up is a permutation of two registers.
  using Column = std::array<float, most_rings>;
  struct Rings {
    alignas(64) Column theta{};
    alignas(64) Column cosine{};     ///< of theta
    alignas(64) Column per_width{};  ///< 1 / (theta of the next ring - theta)
    alignas(64) Column steps{};      ///< a radian
    alignas(64) Column zero{};       ///< steps from the ring's first pair to phi = 0
    alignas(64) Column first{};      ///< of the ring, in pairs_
  };
  /// Bilinear places: the upper ring's, then the lower's.
  struct Bilinear {
    std::array<Wide, 2> pair;  ///< in pairs_
    std::array<Wide, 4> weight;
  };
  Bilinear place(const Wide& x, const Wide& y, const Wide& z) const;
  // Between a ring and the next: what one direction needs of the two, side by side in a cache line.
  // Filled up to four of each, which are loaded at once.
  struct alignas(64) Band {
    float theta = 0;
    float per_width = 0;
    alignas(16) std::array<float, 4> steps{};
    std::array<float, 4> zero{};
    std::array<std::int32_t, 4> first{};
  };
  const Band& band_of(float cosine) const;
  void append_ring(std::span<const std::uint16_t> directions, float theta, float first_phi);

  std::size_t ring_count_ = 0;  // 0: the triangulation answers
  Rings rings_;                 // the pole first, theta ascending
  std::vector<Band> bands_;     // that of each ring but the last
  // Each ring's directions and their successors, ring by ring, phi ascending; twice around and a
  // bit more, so that no phi has to be brought into a range.
  std::vector<std::array<std::int32_t, 2>> pairs_;
  std::vector<float> glsl_rings_;          // theta, first phi, count, first in order_
  std::vector<std::uint16_t> glsl_order_;  // ring by ring, phi ascending
  BatchLocator triangulation_;
};

}  // namespace weft
