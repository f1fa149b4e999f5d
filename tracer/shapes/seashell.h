// A conch: a closed elliptic tube along a logarithmic helico-spiral.
//
// With (t, s) the angle along the spiral and around the tube, and the tube's width factor w (1 but
// at its ends),
//   P = e^{k t} ((a + w b cos s) cos t, (a + w b cos s) sin t, w c sin s - h),
// so that both |dP/dt| and |dP/ds| grow as e^{k t}: a texture laid in (u, v) ~ (t, s) keeps its
// proportions all along the shell and grows with it, as the shell's own ornament does. The apex is
// at the origin, above. At the aperture the surface rolls over a rounded lip into a bowl; it is
// closed, and shows no back side.
#pragma once

#include "settings/settings.h"
#include "tracer/triangle_mesh.h"

namespace weft {

TriangleMesh make_seashell(const Settings& settings);

}  // namespace weft
