// A periodic height field over the tile as a grid of quads.
#pragma once

#include <functional>

#include "tracer/polygon_mesh.h"

namespace weft {

/// columns x rows quads with (columns + 1) x (rows + 1) vertices, row by row from the lowest y;
/// vertex (i, j) lies at
/// ((i + shift) / columns, (j + shift) / rows), and has the height of (i mod columns, j mod rows).
/// Each quad begins at its (x min, y min) corner, so that a fan cuts it from there to (x max, y
/// max). All faces have the material "default".
PolygonMesh height_grid(int columns, int rows, double shift,
                        const std::function<double(int column, int row)>& height);

}  // namespace weft
