#include "acquisition/offgrid.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <system_error>

#include "btf/atomic_file.h"
#include "btf/btf_file.h"
#include "btf/error.h"
#include "btf/random.h"
#include "btf/view_file.h"

namespace weft {

namespace fs = std::filesystem;

namespace {

// Apart from the numbers of a dataset's own views.
constexpr std::uint64_t first_key = 1ULL << 32;

// Evenly over the solid angle between the normal and the set's lowest direction.
Direction random_direction(std::span<const Direction> set, std::uint64_t hash) {
  float lowest = 1;
  for (const Direction& d : set) lowest = std::min(lowest, d.z);
  const float z = 1 - (1 - lowest) * unit_float(hash);
  const double phi = 2 * std::numbers::pi * unit_float(hash << 32);
  return from_spherical(std::acos(std::clamp(z, 0.0F, 1.0F)), static_cast<float>(phi));
}

nlohmann::ordered_json angles(const Direction& d) {
  return {{"theta", degrees(theta_of(d))}, {"phi", degrees(phi_of(d))}};
}

bool is_kept(const fs::path& path, const std::string& provenance) {
  return fs::exists(path) && read_view_header(path).provenance == provenance;
}

}  // namespace

AcquisitionReport acquire_offgrid(const Mesostructure& mesostructure,
                                  const AcquisitionSettings& settings, std::size_t count,
                                  const fs::path& folder, Progress& progress) {
  const auto begin = std::chrono::steady_clock::now();
  const fs::path offgrid = folder / "offgrid";
  std::error_code error;
  fs::create_directories(offgrid, error);
  if (error) throw failed(offgrid.string(), "cannot be created: " + error.message());
  const std::vector<Direction> views = named_directions(settings.views);
  const std::vector<Direction> lights = named_directions(settings.lights);
  const auto structure = std::make_shared<const TraceableStructure>(mesostructure);
  const std::string provenance = provenance_of(mesostructure, settings);
  TraceSettings trace = settings.trace;
  trace.texel_errors = trace.spp > 1;
  trace.indirect_cache = false;  // what others are held against is not biased
  AcquisitionReport report;
  report.lights = 1;
  nlohmann::ordered_json pairs = nlohmann::json::array();
  progress.start(static_cast<std::int64_t>(count), "pairs", "rays");
  for (std::size_t i = 0; i < count; ++i) {
    const Direction view = random_direction(views, hash_coordinates(trace.seed, first_key + i, 0));
    const Direction light =
        random_direction(lights, hash_coordinates(trace.seed, first_key + i, 1));
    const std::string name = fmt::format("pair_{:03}.exr", i);
    pairs.push_back({{"file", name}, {"view", angles(view)}, {"light", angles(light)}});
    if (is_kept(offgrid / name, provenance)) {
      ++report.views_kept;
      progress.advance(1);
      continue;
    }
    const TracedView traced = ViewTracer(structure, {light}, trace).trace(view, first_key + i);
    check_storable(i, traced.values, trace.width, trace.height, PixelType::float32);
    write_view_file(offgrid / name, {trace.width, trace.height, PixelType::float32, provenance},
                    view, std::span(&light, 1),
                    {.values = traced.values,
                     .standard_errors = traced.standard_errors,
                     .texel_errors = traced.texel_errors,
                     .coverage = {}});
    report.statistics += traced.statistics;
    progress.advance(1, traced.statistics.rays());
  }
  progress.finish();
  const nlohmann::ordered_json json = {{"quantity", traced_quantity},
                                       {"texels", {trace.width, trace.height}},
                                       {"pairs", pairs},
                                       {"provenance", nlohmann::json::parse(provenance)}};
  write_text_atomically(offgrid / "offgrid.json", json.dump(1) + "\n");
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return report;
}

}  // namespace weft
