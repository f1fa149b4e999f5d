#include "acquisition/naive_tracer.h"

#include <tbb/parallel_for.h>

#include <atomic>
#include <cmath>

#include "btf/random.h"
#include "tracer/frame.h"

namespace weft {

namespace {

// One path's random numbers, in the order in which they are asked for.
class Numbers {
 public:
  Numbers(std::uint64_t seed, std::uint64_t key, std::uint64_t texel, std::uint64_t sample)
      : key_(hash_coordinates(seed, key, texel, sample)) {}
  float next() { return unit_float(hash_coordinates(key_, count_++)); }

 private:
  std::uint64_t key_;
  std::uint64_t count_ = 0;
};

class PathWalk {
 public:
  PathWalk(const TraceableStructure& structure, const TraceSettings& settings,
           const Direction& view, const Direction& light)
      : structure_(structure), settings_(settings), view_(view), light_(light) {}

  // B of one path through texel (x, y).
  Imath::V3d walk(int x, int y, Numbers numbers) {
    const PeriodicScene& scene = structure_.scene;
    const float start = scene.top() + 1e-3F * std::max(1.0F, std::abs(scene.top()));
    const float back = (start - structure_.mesostructure.reference_height) / view_.z;
    const float px = (static_cast<float>(x) + numbers.next()) / static_cast<float>(settings_.width);
    const float py =
        1 - (static_cast<float>(y) + numbers.next()) / static_cast<float>(settings_.height);
    Vec3 origin(tile_fraction(px + view_.x * back), tile_fraction(py + view_.y * back), start);
    Vec3 direction = -view_;
    Rgb throughput(1, 1, 1);
    Imath::V3d sum(0, 0, 0);
    for (int bounce = 0; bounce <= std::min(settings_.max_bounces, PathEnd::most_bounces);
         ++bounce) {
      ++rays_;
      const RayHit hit = scene.intersect(origin, direction);
      if (!hit.hit()) break;
      const Met met = structure_.facets.size() > hit.primitive ? meet_facet(hit, direction)
                                                               : meet_curve(hit, direction);
      if (met.degenerate) break;
      const Frame frame = frame_around(met.shading_normal);
      const Bsdf& bsdf = structure_.mesostructure.materials[met.material];
      const Direction towards_viewer = frame.to_local(-direction);
      origin = ray_origin(met.point, met.facet_normal);
      if ((met.facet_normal ^ light_) > 0) {
        ++rays_;
        if (!scene.intersect(origin, light_).hit())
          sum += Imath::V3d(bsdf.evaluate(frame.to_local(light_), towards_viewer) * throughput);
      }
      const Bsdf::Sample sample =
          bsdf.sample(towards_viewer, {numbers.next(), numbers.next(), numbers.next()});
      if (!(sample.pdf > 0)) break;
      direction = frame.to_world(sample.light).normalized();
      if (!((direction ^ met.facet_normal) > 0)) break;
      throughput *= sample.weight;
      const float brightness = max_component(throughput);
      if (brightness < PathEnd::dim) {
        if (!(numbers.next() * PathEnd::dim < brightness)) break;
        throughput *= PathEnd::dim / brightness;
      }
    }
    return sum;
  }

  std::int64_t rays() const { return rays_; }

 private:
  // Where a ray has arrived; normals on its side.
  struct Met {
    Vec3 point;
    Vec3 facet_normal;
    Vec3 shading_normal;
    std::uint16_t material = 0;
    bool degenerate = false;
  };

  Met meet_facet(const RayHit& hit, const Vec3& direction) const {
    const Facet& facet = structure_.facets[hit.primitive];
    if (facet.degenerate())
      return {.point = {}, .facet_normal = {}, .shading_normal = {}, .degenerate = true};
    const bool behind = (facet.normal ^ direction) > 0;
    const Vec3 normal = behind ? -facet.normal : facet.normal;
    return {facet.point(hit.u, hit.v), normal,
            shading_normal(structure_.mesostructure.mesh, hit.primitive, hit.u, hit.v, normal,
                           behind, direction),
            facet.material, false};
  }

  Met meet_curve(const RayHit& hit, const Vec3& direction) const {
    const CurveSet& curves = structure_.mesostructure.curves;
    const std::size_t segment = hit.primitive - structure_.facets.size();
    const CurvePoint point = curve_point(curves, segment, hit.u, hit.v);
    const Vec3 normal = (point.normal ^ direction) > 0 ? -point.normal : point.normal;
    return {point.position, normal, normal, curves.materials[segment], false};
  }

  const TraceableStructure& structure_;
  const TraceSettings& settings_;
  Direction view_;
  Direction light_;
  std::int64_t rays_ = 0;
};

}  // namespace

NaiveEstimate trace_pair_naively(const TraceableStructure& structure, const TraceSettings& settings,
                                 const Direction& view, const Direction& light, std::uint64_t key) {
  NaiveEstimate estimate;
  const std::size_t values = static_cast<std::size_t>(3) * settings.width * settings.height;
  estimate.values.resize(values);
  estimate.variances.resize(values);
  std::atomic<std::int64_t> rays = 0;
  tbb::parallel_for(0, settings.height, [&](int y) {
    PathWalk path(structure, settings, view, light);
    for (int x = 0; x < settings.width; ++x) {
      const std::size_t texel = static_cast<std::size_t>(y) * settings.width + x;
      Imath::V3d sum(0, 0, 0);
      Imath::V3d squares(0, 0, 0);
      for (int s = 0; s < settings.spp; ++s) {
        const Imath::V3d value =
            path.walk(x, y, Numbers(settings.seed, key, texel, static_cast<std::uint64_t>(s)));
        sum += value;
        squares += value * value;
      }
      const double n = settings.spp;
      for (int c = 0; c < 3; ++c) {
        const double mean = sum[c] / n;
        estimate.values[3 * texel + static_cast<std::size_t>(c)] = mean;
        estimate.variances[3 * texel + static_cast<std::size_t>(c)] =
            n > 1 ? std::max(0.0, squares[c] / n - mean * mean) / (n - 1) : 0;
      }
    }
    rays += path.rays();
  });
  estimate.rays = rays;
  return estimate;
}

}  // namespace weft
