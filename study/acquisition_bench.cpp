#include "study/acquisition_bench.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <span>

#include "acquisition/naive_tracer.h"
#include "acquisition/path_block.h"
#include "btf/random.h"

namespace weft {

namespace {

double seconds_of(const auto& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Seconds of each form of call for one kind of query.
struct FormTimes {
  static constexpr std::array<const char*, 3> names = {"coherent packets", "incoherent packets",
                                                       "single rays"};
  std::array<double, 3> seconds{};

  FormTimes& operator+=(const FormTimes& other) {
    for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += other.seconds[i];
    return *this;
  }
  std::size_t best() const {
    return static_cast<std::size_t>(std::ranges::min_element(seconds) - seconds.begin());
  }
};

struct EmbreeTimes {
  FormTimes primary, bounce, first_shadows, later_shadows;
};

const RayPacket& rays_of(const RayPacket& packet) {
  return packet;
}
const RayPacket& rays_of(const HitPacket& packet) {
  return packet.ray;
}
RayPacket& rays_of(RayPacket& packet) {
  return packet;
}
RayPacket& rays_of(HitPacket& packet) {
  return packet.ray;
}
void trace(const RayScene& scene, RayPacket& packet, std::uint16_t active, Coherence coherence) {
  scene.occluded(packet, active, coherence);
}
void trace(const RayScene& scene, HitPacket& packet, std::uint16_t active, Coherence coherence) {
  scene.intersect(packet, active, coherence);
}

// Each form on fresh copies, which are made ready before the clock starts.
template <typename Entry>
FormTimes times_of(const PeriodicScene& scene, std::vector<Entry> entries) {
  for (Entry& entry : entries) scene.bound(rays_of(entry.packet));
  FormTimes times;
  for (std::size_t form = 0; form < 2; ++form) {
    std::vector<Entry> copies = entries;
    const Coherence coherence = form == 0 ? Coherence::coherent : Coherence::incoherent;
    times.seconds[form] = seconds_of([&] {
      for (Entry& entry : copies) trace(scene.copies(), entry.packet, entry.active, coherence);
    });
  }
  constexpr bool occlusion = std::is_same_v<decltype(Entry::packet), RayPacket>;
  std::int64_t hits = 0;
  times.seconds[2] = seconds_of([&] {
    for (const Entry& entry : entries) {
      const RayPacket& p = rays_of(entry.packet);
      for (int i = 0; i < lanes; ++i) {
        if ((entry.active >> i & 1) == 0) continue;
        const Vec3 origin(p.ox[i], p.oy[i], p.oz[i]);
        const Vec3 direction(p.dx[i], p.dy[i], p.dz[i]);
        if constexpr (occlusion)
          hits += scene.copies().occluded(origin, direction, 0, p.tfar[i]) ? 1 : 0;
        else
          hits += scene.copies().intersect(origin, direction, 0, p.tfar[i]).hit() ? 1 : 0;
      }
    }
  });
  if (hits < 0) times.seconds[2] = 0;  // what is counted may not be left out
  return times;
}

// Every eighth view and every fourth block of texels stand for all.
constexpr std::size_t view_step = 8;
constexpr int block_step = 4;

void measure_embree(const std::shared_ptr<const TraceableStructure>& structure,
                    const AcquisitionSettings& settings, AcquisitionBench& bench) {
  const std::vector<Direction> views = named_directions(settings.views);
  TraceSettings trace_settings = settings.trace;
  trace_settings.table = false;  // every query comes as a ray
  const ViewTracer tracer(structure, named_directions(settings.lights), trace_settings);
  const int edge = PathBlock::edge_for(tracer.lights().size());
  const int columns = (settings.trace.width + edge - 1) / edge;
  const int blocks = columns * ((settings.trace.height + edge - 1) / edge);
  std::vector<std::array<int, 2>> jobs;  // view, block
  for (std::size_t v = 0; v < views.size(); v += view_step) {
    for (int b = static_cast<int>(v / view_step) % block_step; b < blocks; b += block_step)
      jobs.push_back({static_cast<int>(v), b});
  }
  EmbreeTimes sum;
  std::mutex mutex;
  tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t j) {
    const auto [v, b] = jobs[j];
    PacketLog log;
    PathBlock block(tracer, &log);
    block.trace(views[v], static_cast<std::uint64_t>(v), settings.trace.spp, {}, b % columns * edge,
                b / columns * edge);
    const PeriodicScene& scene = tracer.scene();
    const EmbreeTimes times{times_of(scene, std::move(log.primary)),
                            times_of(scene, std::move(log.bounce)),
                            times_of(scene, std::move(log.first_shadows)),
                            times_of(scene, std::move(log.later_shadows))};
    const std::scoped_lock lock(mutex);
    sum.primary += times.primary;
    sum.bounce += times.bounce;
    sum.first_shadows += times.first_shadows;
    sum.later_shadows += times.later_shadows;
  });
  double seconds = 0;
  const auto take = [&](const FormTimes& times, std::string& form) {
    form = FormTimes::names[times.best()];
    seconds += times.seconds[times.best()];
  };
  take(sum.primary, bench.primary_form);
  take(sum.bounce, bench.bounce_form);
  take(sum.first_shadows, bench.first_shadow_form);
  take(sum.later_shadows, bench.later_shadow_form);
  const double whole =
      static_cast<double>(views.size()) * blocks / static_cast<double>(jobs.size());
  bench.embree_seconds = seconds * whole / tbb::this_task_arena::max_concurrency();
  bench.roofline_ratio = bench.embree_seconds / bench.full_dataset_seconds;
}

// Mean square error from two independent runs: half the mean square of their difference.
template <typename Values>
double mean_square_error(const Values& a, const Values& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double d = static_cast<double>(a[i]) - b[i];
    sum += d * d;
  }
  return sum / 2 / static_cast<double>(a.size());
}

void measure_speedup(const std::shared_ptr<const TraceableStructure>& structure,
                     const AcquisitionSettings& settings, AcquisitionBench& bench) {
  const std::vector<Direction> views = named_directions(settings.views);
  const std::vector<Direction> lights = named_directions(settings.lights);
  TraceSettings ours = settings.trace;
  ours.views = views.size();
  TraceSettings other_seed = ours;
  other_seed.seed = mix_bits(ours.seed + 1);
  const ViewTracer tracer(structure, lights, ours);
  const ViewTracer other(structure, lights, other_seed);
  TraceSettings naive = settings.trace;
  naive.spp = naive_bench_spp;
  double naive_seconds = 0;
  double naive_square = 0;
  double square = 0;
  int pairs = 0;
  for (const std::size_t v : {std::size_t{0}, views.size() / 2, views.size() - 1}) {
    const TracedView a = tracer.trace(views[v], v);
    const TracedView b = other.trace(views[v], v);
    const std::size_t n = a.values.size() / lights.size();
    for (std::size_t l = 0; l < lights.size(); l += std::max<std::size_t>(1, lights.size() / 5)) {
      ++pairs;
      square += mean_square_error(std::span(a.values).subspan(l * n, n),
                                  std::span(b.values).subspan(l * n, n));
      std::array<NaiveEstimate, 2> estimates;
      for (std::size_t k = 0; k < 2; ++k) {
        naive_seconds += seconds_of([&] {
          estimates[k] =
              trace_pair_naively(*structure, naive, views[v], lights[l], hash_coordinates(v, l, k));
        });
      }
      naive_square += mean_square_error(estimates[0].values, estimates[1].values);
    }
  }
  bench.naive_seconds_a_pair = naive_seconds / (2 * pairs);
  bench.naive_rmse = std::sqrt(naive_square / pairs);
  bench.rmse = std::sqrt(square / pairs);
  const double seconds_a_pair =
      bench.full_dataset_seconds / static_cast<double>(views.size() * lights.size());
  bench.speedup_equal_rmse = bench.naive_seconds_a_pair * naive_square / (seconds_a_pair * square);
}

AcquisitionReport acquire_once(const Mesostructure& mesostructure,
                               const AcquisitionSettings& settings,
                               const std::filesystem::path& folder, Progress& progress) {
  std::filesystem::remove_all(folder);
  AcquisitionReport report = acquire(mesostructure, settings, folder, progress);
  std::filesystem::remove_all(folder);
  return report;
}

double samples_per_second(const AcquisitionReport& report) {
  return static_cast<double>(report.statistics.paths) * static_cast<double>(report.lights) /
         report.seconds;
}

IndirectCacheBench bench_indirect_cache(const std::shared_ptr<const TraceableStructure>& structure,
                                        const AcquisitionSettings& settings,
                                        const std::filesystem::path& folder, Progress& progress) {
  AcquisitionSettings cached = settings;
  cached.trace.indirect_cache = true;
  IndirectCacheBench bench;
  const AcquisitionReport report = acquire_once(structure->mesostructure, cached, folder, progress);
  bench.full_dataset_seconds = report.seconds;
  bench.samples_per_second = samples_per_second(report);
  const std::vector<Direction> views = named_directions(settings.views);
  const std::vector<Direction> lights = named_directions(settings.lights);
  cached.trace.views = views.size();
  TraceSettings traced = cached.trace;
  traced.indirect_cache = false;
  traced.spp *= 4;
  const ViewTracer with(structure, lights, cached.trace);
  const ViewTracer without(structure, lights, traced);
  int pairs = 0;
  for (std::size_t v = 0; v < views.size(); v += std::max<std::size_t>(1, views.size() / 8)) {
    const TracedView a = with.trace(views[v], v);
    const TracedView b = without.trace(views[v], mix_bits(v));
    const std::size_t n = a.values.size() / lights.size();
    for (std::size_t l = 0; l < lights.size(); ++l) {
      const auto mean = [&](const TracedView& view) {
        const auto values = std::span(view.values).subspan(l * n, n);
        return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n);
      };
      const double truth = mean(b);
      if (!(truth > 0)) continue;
      const double difference = mean(a) / truth - 1;
      ++pairs;
      bench.bias += difference;
      bench.rms_difference += difference * difference;
      bench.standard_error += std::hypot(a.standard_errors[l], b.standard_errors[l]) / truth;
    }
  }
  if (pairs == 0) return bench;
  bench.bias /= pairs;
  bench.rms_difference = std::sqrt(bench.rms_difference / pairs);
  bench.standard_error /= pairs;
  return bench;
}

}  // namespace

AcquisitionBench bench_acquisition(const std::string& name, const Mesostructure& mesostructure,
                                   const AcquisitionSettings& settings,
                                   const std::filesystem::path& folder, Progress& progress) {
  AcquisitionBench bench;
  bench.structure = name;
  bench.lambert = !IndirectCache::obstacle(mesostructure);
  const AcquisitionReport report = acquire_once(mesostructure, settings, folder, progress);
  bench.statistics = report.statistics;
  bench.full_dataset_seconds = report.seconds;
  bench.samples_per_second = samples_per_second(report);
  bench.rays_per_second = static_cast<double>(report.statistics.rays()) / report.seconds;
  const auto structure = std::make_shared<const TraceableStructure>(mesostructure);
  measure_embree(structure, settings, bench);
  measure_speedup(structure, settings, bench);
  if (bench.lambert)
    bench.indirect_cache = bench_indirect_cache(structure, settings, folder, progress);
  return bench;
}

std::vector<Bar> acquisition_bars(const AcquisitionBench& b) {
  const auto what = [&](const char* words) { return b.structure + ": " + words; };
  std::vector<Bar> bars = {
      {what("samples a second"), "M", b.samples_per_second / 1e6, b.lambert ? 120.0 : 40.0, true},
      {what("Embree alone over all"), "times", b.roofline_ratio, b.lambert ? 2.5 : 1.0, true},
      {what("time x error^2, plain way over ours"), "times", b.speedup_equal_rmse, 25, true}};
  if (b.lambert) bars.push_back({what("whole dataset"), "s", b.full_dataset_seconds, 20});
  return bars;
}

namespace {

constexpr std::array<int, 3> cost_factors = {1, 2, 4};
constexpr int cost_runs = 3;

// The settings with `size` at `factor` quarters of what they say. Directions are evenly spread, so
// that few of them are as steep on average as many.
AcquisitionSettings part_of(const AcquisitionSettings& settings, const std::string& size,
                            int factor) {
  const auto part = [&](const std::string& name, std::size_t whole) {
    return name == size ? std::max<std::size_t>(1, whole * factor / 4) : whole;
  };
  AcquisitionSettings some = settings;
  some.trace.height = static_cast<int>(part("texels", static_cast<std::size_t>(some.trace.height)));
  some.trace.spp = static_cast<int>(part("spp", static_cast<std::size_t>(some.trace.spp)));
  some.views = fmt::format("fibonacci:{}", part("views", named_directions(settings.views).size()));
  some.lights =
      fmt::format("fibonacci:{}", part("lights", named_directions(settings.lights).size()));
  return some;
}

}  // namespace

std::vector<AcquisitionCost> acquisition_costs(const Mesostructure& mesostructure,
                                               const AcquisitionSettings& settings,
                                               const std::filesystem::path& folder,
                                               Progress& progress) {
  std::vector<AcquisitionCost> costs;
  for (const std::string size : {"texels", "spp", "views", "lights"}) {
    for (const int factor : cost_factors)
      costs.push_back({size, factor, std::numeric_limits<double>::infinity()});
  }
  // In turn, so that the machine's slower moments fall on all.
  for (int i = 0; i < cost_runs; ++i) {
    for (AcquisitionCost& cost : costs) {
      const AcquisitionSettings some = part_of(settings, cost.size, cost.factor);
      cost.seconds =
          std::min(cost.seconds, acquire_once(mesostructure, some, folder, progress).seconds);
    }
  }
  return costs;
}

std::vector<Bar> cost_bars(const std::vector<AcquisitionCost>& costs) {
  constexpr double linear = 4;  // of four times as much
  constexpr double clearly_less = 3;
  std::vector<Bar> bars;
  double one = 0;
  for (const AcquisitionCost& cost : costs) {
    if (cost.factor == cost_factors.front()) one = cost.seconds;
    if (cost.factor == cost_factors.back()) {
      bars.push_back({cost.size + " x 4: time", "times", cost.seconds / one,
                      cost.size == "lights" ? clearly_less : linear});
    }
  }
  return bars;
}

}  // namespace weft
