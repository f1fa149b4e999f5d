// Yarns of cloth as cages of subdivision surfaces: tubes of twisted plies along a straight axis,
// which rise and sink on their way across the tile.
#pragma once

#include <cstdint>
#include <vector>

#include "tracer/polygon_mesh.h"

namespace weft {

/// The cross-section of a yarn, cut perpendicular to the tile's axis, and its plies.
struct YarnForm {
  double half_width;      ///< in tiles
  double half_thickness;  ///< in tiles
  double spacing;         ///< of the yarns of its family, in tiles; at least 2 half widths
  int plies;              ///< strands; 0: a smooth yarn
  double ply_depth;       ///< of the grooves between plies, in yarn radii, below 1
  int twist;              ///< turns of the plies in a tile
  int sections;           ///< control points around the yarn
};

/// Where a yarn goes. `side` x `axis` points down, so that faces look outwards.
struct YarnPath {
  Imath::V3d axis, side;        ///< unit vectors along x and y, or along y and x
  Imath::V3d begin;             ///< of the centre line, at height 0
  std::vector<double> heights;  ///< of the centre line at control rings, evenly over the tile
};

/// S(cos(pi t)) with S(c) = c sqrt(2 / (1 + c^2)): how high a centre line is `t` spacings after a
/// crossing where it is at 1, on its way to -1 at t = 1.
double crossing_height(double t);

/// Adds the cage of one yarn, which closes with itself over the tile's border. Its limit surface
/// lies within an ellipse around the centre line, and at t spacings beside it within the half
/// thickness times `crossing_height(t)`: the ellipse alone up to a width of 0.86 spacings, a lens
/// where neighbours touch. So crossing yarns never meet where each centre line stays outside A
/// S(cos(pi t)) with A at least the other's half thickness.
void add_yarn(PolygonMesh& cage, const YarnForm& form, const YarnPath& path,
              std::uint16_t material);

}  // namespace weft
