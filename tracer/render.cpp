#include "tracer/render.h"

#include <fmt/core.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "btf/error.h"
#include "tracer/integrator.h"
#include "tracer/traced_scene.h"

namespace weft {
namespace {

constexpr int tile_size = 16;
/// Paths that go on together: enough for streams of rays, little enough for the caches of one core.
constexpr int paths_per_batch = 4096;

void check(const RenderSettings& settings) {
  if (settings.samples_per_pixel < 1) {
    throw bad_input("--spp", fmt::format("{} samples a pixel, expected at least 1",
                                         settings.samples_per_pixel));
  }
  if (settings.max_bounces < 0) {
    throw bad_input("--max-bounces", fmt::format("{}, expected at least 0", settings.max_bounces));
  }
  if (settings.lod && !(std::isfinite(*settings.lod) && *settings.lod >= 0)) {
    throw bad_input("--lod", fmt::format("{}, expected at least 0", *settings.lod));
  }
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void trace_tile(PathBatch& batch, const TracedScene& scene, const RenderSettings& settings,
                int tile_x, int tile_y, Film& film) {
  const int x0 = tile_x * tile_size, x1 = std::min(x0 + tile_size, scene.camera.width());
  const int y0 = tile_y * tile_size, y1 = std::min(y0 + tile_size, scene.camera.height());
  const int samples = paths_per_batch / (tile_size * tile_size);
  for (int first = 0; first < settings.samples_per_pixel; first += samples) {
    const int last = std::min(first + samples, settings.samples_per_pixel);
    batch.trace(x0, y0, x1, y1, first, last, film);
  }
}

}  // namespace

RenderResult render(const Scene& scene, const RenderSettings& settings, Progress& progress) {
  check(settings);
  const auto begin = std::chrono::steady_clock::now();
  const TracedScene traced(scene);
  RenderResult result;
  RenderStatistics& statistics = result.statistics;
  statistics.build_seconds = seconds_since(begin);

  Film film(traced.camera.width(), traced.camera.height());
  const int columns = (traced.camera.width() + tile_size - 1) / tile_size;
  const int rows = (traced.camera.height() + tile_size - 1) / tile_size;
  oneapi::tbb::enumerable_thread_specific<PathBatch> batches(
      [&] { return PathBatch(traced, settings); });
  const auto traced_from = std::chrono::steady_clock::now();
  progress.start(static_cast<std::int64_t>(columns) * rows, "tiles");
  oneapi::tbb::parallel_for(0, columns * rows, [&](int tile) {
    trace_tile(batches.local(), traced, settings, tile % columns, tile / columns, film);
    progress.advance(1);
  });
  progress.finish();
  statistics.seconds = seconds_since(traced_from);
  for (const PathBatch& batch : batches) {
    statistics.rays += batch.rays();
    statistics.evaluations += batch.evaluations();
  }
  statistics.samples = static_cast<std::int64_t>(traced.camera.width()) * traced.camera.height() *
                       settings.samples_per_pixel;
  statistics.invalid = film.invalid();
  result.image = film.image();
  result.variance = film.variance();
  return result;
}

}  // namespace weft
