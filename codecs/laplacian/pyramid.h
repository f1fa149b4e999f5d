// The grids of a Laplacian pyramid and its two filters (paper 000, section 3.1): what a coarser
// level is made of, and what it says about a finer one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace weft::laplacian {

/// Down and up filter. `box3`: the paper's 3 x 3 box and nearest neighbour. `box2`: the mean of the
/// texels whose nearest parent it is, so that each parent's Laplacian coefficients sum to zero.
/// `linear`: (1, 3, 3, 1) / 8 and bilinear.
enum class Filters { box3, box2, linear };

std::string name_of(Filters filters);

/// A texel of a coarser or finer level and its weight.
struct Tap {
  std::size_t texel;
  double weight;
};

/// Levels 0 to `top` of a tile that repeats; level k has (width >> k) x (height >> k) texels.
struct Pyramid {
  int width = 1;
  int height = 1;
  int top = 0;  ///< the paper's lambda_max
  Filters filters = Filters::box3;

  int width_of(int level) const { return width >> level; }
  int height_of(int level) const { return height >> level; }
  std::size_t texels(int level) const {
    return static_cast<std::size_t>(width_of(level)) * height_of(level);
  }

  /// Equation 2: the texels of level - 1 whose weighted sum is `texel` of `level`.
  std::vector<Tap> down(int level, std::size_t texel) const;
  /// The texels of `coarse` whose weighted sum is said about `texel` of `fine`, coarse > fine; the
  /// up filter of equation 3, coarse - fine times for the boxes, at once for `linear`.
  std::vector<Tap> up(int fine, std::size_t texel, int coarse) const;
};

/// Nearest parent of column (or row) x of `fine` at `coarse`, whose size is `coarse_size`.
inline int parent(int x, int levels_between, int coarse_size) {
  const int p = x >> levels_between;
  return p < coarse_size ? p : coarse_size - 1;  // odd sizes
}

/// The most levels above the first, log2 of the shorter side.
int most_levels(int width, int height);

/// The paper's: the construction stops when the number of texels is close to the number of
/// components, at 2 n here: 4 levels above the first for 64 x 64 texels and n = 8.
int usual_top(int width, int height, std::size_t components);

}  // namespace weft::laplacian
