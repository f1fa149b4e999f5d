// A rectangular block with rounded edges as a closed mesh; all but its back is finely divided.
#pragma once

#include "tracer/triangle_mesh.h"

namespace weft {

struct BlockForm {
  double width, height;  ///< along x and y
  double depth;          ///< along z, from the front at z = 0 down
  double rounding;       ///< radius of all edges; at most half of each side
  double spacing;        ///< of the vertices in front and on the sides, about
};

/// Centred at x = y = 0, with outward normals: those of the rounded block itself.
TriangleMesh make_block(const BlockForm& form);

}  // namespace weft
