// How far a BTF is from its reference, picture by picture: a picture is what one pair of light and
// view shows of the tile. Table 1 of paper 000 (Level-of-Detail Representation of BTFs) is made of
// these.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "btf/btf.h"
#include "codecs/representation.h"

namespace weft {

/// Of a number that every pair has.
struct PairSpread {
  double average = 0;
  double least = 0;
  double greatest = 0;
};

struct PairErrors {
  struct Channel {
    PairSpread mse;  ///< mean over texels of the squared difference, 1/sr^2
    PairSpread mae;  ///< mean over texels of the absolute difference, 1/sr
  };
  std::array<Channel, 3> channels;  ///< Y, Cb, Cr of linear RGB (BT.601's weights)
  std::size_t pairs = 0;            ///< whose light and view are above the horizon
};

/// Asks `test` at the reference's texel centres, lights and views, at level 0. All 0 where there is
/// no pair.
/// @param test_name  stands in the error.
/// @throws Error     bad_input where the two have other numbers of texels.
PairErrors pair_errors(const Btf& reference, const Representation& test,
                       const std::string& test_name = "test");

}  // namespace weft
