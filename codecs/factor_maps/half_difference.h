// The half / difference parameterisation (GSHD, Kautz and McCool) and the two linear operators that
// it needs: resampling an ABRDF into it, averaged over the differences, and looking the half map up
// at every pair.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "btf/hemisphere_sampling.h"
#include "codecs/factor_maps/lanes.h"
#include "codecs/factor_maps/parabolic_map.h"

namespace weft::factor_maps {

/// A sparse matrix by rows; row r holds entries start[r] to start[r + 1].
struct SparseRows {
  std::vector<std::uint32_t> start{0};
  std::vector<std::uint32_t> column;
  std::vector<float> weight;
};

/// Every row times the lanes' vector.
LaneVector multiply(const SparseRows& matrix, const LaneVector& vector);

struct DirectionPair {
  Direction light;
  Direction view;
};

/// The pair whose half-vector is `half` and whose light is `difference` in the frame that
/// Gram-Schmidt makes of (half, +x). Both may come out below the horizon.
DirectionPair pair_of(const Direction& half, const Direction& difference);

/// Half-vector of two directions on the upper hemisphere.
inline Direction half_vector(const Direction& light, const Direction& view) {
  return (light + view).normalized();
}

/// The light in the frame of the half-vector: the difference that `pair_of` takes. Its z is >= 0.
Direction difference_vector(const Direction& light, const Direction& view);

/// The operator from an ABRDF's [light][view] pairs to a map over the half-vector: for each of the
/// map's texels the mean, over a grid of `rings` x 2 `rings` differences in (theta, phi), of the
/// ABRDF interpolated where light and view are above the horizon. The paper's F_hd and the mean of
/// its columns (section 4.2.3), in one sparse matrix.
SparseRows half_average(const HemisphereSampling& lights, const HemisphereSampling& views,
                        const ParabolicMap& map, int rings);

/// The half map's texels that each [light][view] pair asks for.
std::vector<BilinearTaps> half_lookup(const HemisphereSampling& lights,
                                      const HemisphereSampling& views, const ParabolicMap& map);

/// The difference map's texels that each [light][view] pair asks for.
std::vector<BilinearTaps> difference_lookup(const HemisphereSampling& lights,
                                            const HemisphereSampling& views,
                                            const ParabolicMap& map);

/// Bilinear lookup of a map over half-vectors or differences at each pair.
LaneVector looked_up(const LaneVector& map, std::span<const BilinearTaps> lookup);

}  // namespace weft::factor_maps
