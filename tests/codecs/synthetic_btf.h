// BTFs of known formulas for the codecs' tests.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "btf/btf.h"
#include "codecs/representation.h"

namespace weft {

/// f = B / cos(theta_light) at a texel.
using Formula = std::function<Rgb(int x, int y, const Direction& light, const Direction& view)>;

/// A float BTF of `formula` over the named directions (see `named_directions`).
std::shared_ptr<const Btf> synthetic_btf(int width, int height, const std::string& lights,
                                         const std::string& views, const Formula& formula);

/// Smooth positive functions of one direction, different for each texel and channel.
Rgb light_pattern(int x, int y, const Direction& light);
Rgb view_pattern(int x, int y, const Direction& view);
/// A lobe around a direction near the normal.
Rgb half_pattern(int x, int y, const Direction& half);

/// What a real texel does: two albedos in a checker, a specular lobe about a tilted normal,
/// shadowing of grazing lights and masking of grazing views, each from its own side.
std::shared_ptr<const Btf> realistic_btf(int size, const std::string& directions);

}  // namespace weft
