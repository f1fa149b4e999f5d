// Renders a scene with the path tracer, in tiles on all threads.
//
// The same scene and settings give the same bytes for any number of threads: a sample's random
// numbers are a hash of (seed, pixel, sample, dimension), and a pixel's samples are added in order.
#pragma once

#include <cstdint>
#include <optional>

#include "btf/progress.h"
#include "tracer/film.h"
#include "tracer/scene.h"

namespace weft {

/// `direct` is light that was reflected once, the same picture as `path` with 0 bounces.
enum class Integrator { path, direct };

struct RenderSettings {
  static constexpr int unlimited_bounces = 1 << 30;

  Integrator integrator = Integrator::path;
  int samples_per_pixel = 64;  ///< >= 1
  int max_bounces = 8;         ///< reflections after the first
  PixelFilter filter = PixelFilter::box;
  bool shadows = true;
  /// Level of detail for every query. Absent: at what the camera sees, log2 of the pixel's
  /// footprint in texels, the wider of its two sides; after a bounce, of the width w + d/4, where w
  /// was the footprint's width at the point before and d is the way from there (a cone of 1/16 sr:
  /// what one of 50 strata of a hemisphere sees).
  std::optional<float> lod;
  std::uint64_t seed = 0;
};

struct RenderStatistics {
  double seconds = 0;        ///< of tracing and shading
  double build_seconds = 0;  ///< of the acceleration structure and the lights' distributions
  std::int64_t samples = 0;
  std::int64_t rays = 0;         ///< of all kinds
  std::int64_t evaluations = 0;  ///< queries to appearances
  Film::Invalid invalid;
};

struct RenderResult {
  Image image;     ///< radiance, W/(sr m^2) where lights are in W/sr and W/m^2
  Image variance;  ///< of each pixel's value, estimated from its samples
  RenderStatistics statistics;
};

/// @throws Error  for a scene that cannot be traced or settings out of range.
RenderResult render(const Scene& scene, const RenderSettings& settings, Progress& progress);

}  // namespace weft
