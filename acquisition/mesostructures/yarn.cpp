#include "acquisition/mesostructures/yarn.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft {

namespace {

using Vec3d = Imath::V3d;

/// Control values of the periodic cubic B-spline through `samples`: where limit points are (1, 4,
/// 1) / 6 of their neighbours. Each round leaves at most 2/3 of the error.
std::vector<double> interpolating_controls(const std::vector<double>& samples) {
  std::vector<double> controls = samples;
  const std::size_t n = samples.size();
  for (int round = 0; round < 60; ++round) {
    const std::vector<double> old = controls;
    for (std::size_t i = 0; i < n; ++i) {
      const double limit = (old[(i + n - 1) % n] + 4 * old[i] + old[(i + 1) % n]) / 6;
      controls[i] = old[i] + samples[i] - limit;
    }
  }
  return controls;
}

/// Distance from the centre line as a part of the cross-section's: 1 on the crests of the plies,
/// less between them.
double ply_radius(const YarnForm& form, double angle, double turn) {
  const double phase = angle - 2 * std::numbers::pi * form.twist * turn;
  return 1 - form.ply_depth * (1 - std::abs(std::cos(form.plies * phase / 2)));
}

/// Height of the cross-section, in half thicknesses, above the point of the unit circle at `angle`.
double section_height(const YarnForm& form, double angle) {
  const double beside = form.half_width * std::cos(angle) / form.spacing;
  const double most = std::max(0.0, crossing_height(beside));
  return std::clamp(std::sin(angle), -most, most);
}

/// The cross-section's control points in half widths and half thicknesses, from angle 0 on.
std::vector<Imath::V2d> section_controls(const YarnForm& form) {
  std::vector<double> widths;
  std::vector<double> heights;
  for (int s = 0; s < form.sections; ++s) {
    const double angle = 2 * std::numbers::pi * s / form.sections;
    widths.push_back(std::cos(angle));
    heights.push_back(section_height(form, angle));
  }
  widths = interpolating_controls(widths);
  heights = interpolating_controls(heights);
  std::vector<Imath::V2d> controls;
  for (int s = 0; s < form.sections; ++s) controls.emplace_back(widths[s], heights[s]);
  return controls;
}

}  // namespace

double crossing_height(double t) {
  const double c = std::cos(std::numbers::pi * t);
  return c * std::sqrt(2 / (1 + c * c));
}

void add_yarn(PolygonMesh& cage, const YarnForm& form, const YarnPath& path,
              std::uint16_t material) {
  const int rings = static_cast<int>(path.heights.size());
  const int sections = form.sections;
  const std::vector<double> controls = interpolating_controls(path.heights);
  const std::vector<Imath::V2d> section = section_controls(form);

  const auto first = static_cast<std::uint32_t>(cage.positions.size());
  for (int k = 0; k <= rings; ++k) {
    const double along = static_cast<double>(k) / rings;
    const double turn = static_cast<double>(k % rings) / rings;
    for (int s = 0; s < sections; ++s) {
      const double angle = 2 * std::numbers::pi * s / sections;
      const double radius = ply_radius(form, angle, turn);
      const double height = controls[k % rings] + form.half_thickness * radius * section[s].y;
      cage.positions.emplace_back(path.begin + path.axis * along +
                                  path.side * (form.half_width * radius * section[s].x) +
                                  Vec3d(0, 0, height));
    }
  }
  const auto vertex = [&](int k, int s) {
    return first + static_cast<std::uint32_t>(k * sections + s % sections);
  };
  for (int k = 0; k < rings; ++k) {
    for (int s = 0; s < sections; ++s) {
      for (const std::uint32_t corner :
           {vertex(k, s), vertex(k + 1, s), vertex(k + 1, s + 1), vertex(k, s + 1)}) {
        cage.corners.push_back(corner);
      }
      cage.face_sizes.push_back(4);
      cage.materials.push_back(material);
    }
  }
}

}  // namespace weft
