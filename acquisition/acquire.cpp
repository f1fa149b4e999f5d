#include "acquisition/acquire.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "acquisition/path_block.h"
#include "btf/btf_file.h"
#include "btf/error.h"
#include "btf/process_memory.h"
#include "btf/random.h"

namespace weft {

namespace {

BtfHeader header_of(const Mesostructure& mesostructure, const AcquisitionSettings& settings) {
  return {.width = settings.trace.width,
          .height = settings.trace.height,
          .views = HemisphereSampling(named_directions(settings.views)),
          .lights = HemisphereSampling(named_directions(settings.lights)),
          .pixel_type = settings.pixel_type,
          .tile_size = mesostructure.tile_size,
          .provenance = provenance_of(mesostructure, settings),
          .standard_errors = {}};
}

ViewTracer tracer_for(const Mesostructure& mesostructure, const AcquisitionSettings& settings,
                      const BtfHeader& header) {
  TraceSettings trace = settings.trace;
  trace.views = header.views.size();
  const std::span<const Direction> lights = header.lights.directions();
  return {mesostructure, {lights.begin(), lights.end()}, trace};
}

// A set's name; for a file its content instead, since a path says nothing of what was traced.
std::string directions_record(const std::string& name) {
  if (!name.starts_with("file:")) return name;
  std::uint64_t hash = 0;
  for (const Direction& d : named_directions(name)) {
    hash = hash_coordinates(hash, std::bit_cast<std::uint32_t>(d.x),
                            std::bit_cast<std::uint32_t>(d.y), std::bit_cast<std::uint32_t>(d.z));
  }
  return fmt::format("file of hash {:016x}", hash);
}

}  // namespace

std::string provenance_of(const Mesostructure& mesostructure, const AcquisitionSettings& settings) {
  nlohmann::json json = {{"mesostructure", nlohmann::json::parse(mesostructure.settings)},
                         {"texels", {settings.trace.width, settings.trace.height}},
                         {"spp", settings.trace.spp},
                         {"seed", settings.trace.seed},
                         {"pixel", settings.pixel_type == PixelType::half ? "half" : "float"},
                         {"views", directions_record(settings.views)},
                         {"lights", directions_record(settings.lights)}};
  if (settings.trace.max_bounces == TraceSettings::unlimited)
    json["max_bounces"] = "unlimited";
  else
    json["max_bounces"] = settings.trace.max_bounces;
  if (settings.trace.error > 0) json["error"] = settings.trace.error;
  if (settings.trace.indirect_cache) json["indirect"] = "cache";
  if (settings.trace.texel_errors) json["texel_errors"] = true;
  if (settings.trace.cut_height) json["cut_height"] = *settings.trace.cut_height;
  return json.dump();
}

namespace {

// How many views fit into the memory that is left once the structure is there.
std::size_t views_at_once(const AcquisitionSettings& settings, std::size_t lights) {
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  if (settings.memory == 0) return threads;
  const TraceSettings& trace = settings.trace;
  const std::size_t values = 3 * lights * static_cast<std::size_t>(trace.width) * trace.height;
  const std::size_t view = values * sizeof(float) * (trace.texel_errors ? 2 : 1);
  const std::size_t taken = resident_bytes() + threads * PathBlock::bytes_for(lights);
  if (taken + view > settings.memory) {
    constexpr double mebibyte = 1 << 20;
    throw bad_input(
        "--memory",
        fmt::format("is {:.0f} MiB; expected at least {:.0f} MiB: the structure and one "
                    "view's values",
                    static_cast<double>(settings.memory) / mebibyte,
                    std::ceil(static_cast<double>(taken + view) / mebibyte)));
  }
  return std::min(threads, (settings.memory - taken) / view);
}

// Runs `body` on [0, count), at most `at_once` of them at a time.
void for_each_limited(std::size_t count, std::size_t at_once,
                      const std::function<void(std::size_t)>& body) {
  const bool all = at_once >= static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t step = all ? std::max<std::size_t>(count, 1) : at_once;
  for (std::size_t first = 0; first < count; first += step)
    tbb::parallel_for(first, std::min(first + step, count), body);
}

}  // namespace

AcquisitionReport acquire_shard(const Mesostructure& mesostructure,
                                const AcquisitionSettings& settings, const Shard& shard,
                                const std::filesystem::path& folder, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const BtfHeader header = header_of(mesostructure, settings);
  check_elevations(header.views.directions(), "view");
  AcquisitionReport report;
  report.lights = header.lights.size();
  std::vector<std::size_t> missing = missing_views(folder, header);
  std::erase_if(missing, [&](std::size_t v) { return v % shard.count != shard.index; });
  for (std::size_t v = shard.index; v < header.views.size(); v += shard.count) ++report.views_kept;
  report.views_kept -= missing.size();
  // What is refused is refused before the folder is made, and a tracer costs more than a look.
  std::unique_ptr<const ViewTracer> tracer;
  if (!missing.empty()) {
    tracer.reset(new ViewTracer(tracer_for(mesostructure, settings, header)));
    report.statistics.table_rays = tracer->visibility().rays();
    report.statistics.cache_rays = tracer->indirect_cache().rays();
  }
  const std::size_t at_once = views_at_once(settings, header.lights.size());
  BtfWriter writer(folder, header);
  std::mutex mutex;
  progress.start(static_cast<std::int64_t>(missing.size()), "views", "rays");
  // Views side by side, so that one is written while another is traced.
  for_each_limited(missing.size(), at_once, [&](std::size_t i) {
    const std::size_t v = missing[i];
    if (writer.has_view(v)) {  // another run has written it meanwhile
      progress.advance(1);
      const std::scoped_lock lock(mutex);
      ++report.views_kept;
      return;
    }
    const TracedView view = tracer->trace(header.views[v], v);
    writer.write_view(v, {.values = view.values,
                          .standard_errors = view.standard_errors,
                          .texel_errors = view.texel_errors,
                          .coverage = view.coverage});
    progress.advance(1, view.statistics.rays());
    const std::scoped_lock lock(mutex);
    report.statistics += view.statistics;
  });
  progress.finish();
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

std::vector<std::size_t> finish_acquisition(const Mesostructure& mesostructure,
                                            const AcquisitionSettings& settings,
                                            const std::filesystem::path& folder) {
  const BtfHeader header = header_of(mesostructure, settings);
  std::vector<std::size_t> missing = missing_views(folder, header);
  if (missing.empty()) finish_btf(folder, header);
  return missing;
}

AcquisitionReport acquire(const Mesostructure& mesostructure, const AcquisitionSettings& settings,
                          const std::filesystem::path& folder, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  AcquisitionReport report = acquire_shard(mesostructure, settings, Shard{}, folder, progress);
  finish_btf(folder, header_of(mesostructure, settings));
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

Btf acquire(const Mesostructure& mesostructure, const AcquisitionSettings& settings) {
  const BtfHeader header = header_of(mesostructure, settings);
  check_elevations(header.views.directions(), "view");
  const ViewTracer tracer = tracer_for(mesostructure, settings, header);
  Btf btf(header.width, header.height, header.views, header.lights, header.pixel_type);
  btf.tile_size = header.tile_size;
  btf.provenance = header.provenance;
  for (std::size_t v = 0; v < header.views.size(); ++v) {
    btf.set_view(v, tracer.trace(header.views[v], v).values);
  }
  return btf;
}

}  // namespace weft
