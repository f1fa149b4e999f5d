#include "tracing.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include "acquisition/acquire.h"
#include "tracer/bsdf.h"
#include "tracer/render.h"

namespace {

constexpr float albedo = 0.5F;

bool is_near(const char* what, double found, double expected) {
  std::printf("%s says %.6f, expected %.6f\n", what, found, expected);
  return std::abs(found - expected) < 1e-5;
}

}  // namespace

bool trace_flat_checker() {
  std::ofstream("flat.toml") << "type = 'checker'\nheight = 0\nresolution = 8\n"
                                "[materials.default]\ntype = 'lambert'\nalbedo = 0.5\n";
  const weft::Direction light = weft::from_spherical(weft::radians(50.0), 0.3);
  const weft::TraceSettings settings{.width = 2, .height = 2, .spp = 1, .max_bounces = 0};
  const weft::ViewTracer tracer(weft::read_mesostructure("flat.toml"), {light}, settings);
  const weft::TracedView view = tracer.trace({0, 0, 1}, 0);
  return is_near("the traced pair", view.values.front(), albedo / std::numbers::pi * light.z);
}

bool evaluate_lanes() {
  const weft::Bsdf bsdf = weft::Bsdf::lambert(weft::Rgb(albedo));
  const weft::Direction up(0, 0, 1);
  const weft::Vec3Lanes lights{weft::all_lanes(0), weft::all_lanes(0.6F), weft::all_lanes(0.8F)};
  const weft::RgbLanes answers = bsdf.evaluate(lights, bsdf.view_terms(up));
  const float cosines = weft::dot(up, lights)[15];
  return is_near("the sixteenth light", answers.g[15], albedo / std::numbers::pi * cosines);
}
