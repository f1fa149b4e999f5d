#include "acquisition/view_tracer.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "btf/error.h"
#include "tracer/bsdf_batch.h"
#include "tracer/frame.h"
#include "tracer/sobol.h"

namespace weft {

namespace {

constexpr double lowest_theta = 89.9;   // degrees
constexpr int block_edge = 8;           // texels; a block's paths are traced together
constexpr int samples_at_once = 64;     // of each texel in a block
constexpr std::size_t group_size = 64;  // paths that are connected to the lights together
// Shadow rays of a group to this many lights go to Embree in one stream, which stays in the cache.
constexpr std::size_t lights_at_once = 16;
constexpr int error_groups = 16;  // groups of samples whose spread gives the standard errors
// A path of a closed, white inside (a ray that slipped between touching surfaces) would never end.
constexpr int most_bounces = 4096;
// Paths dimmer than this are ended by Russian roulette; needed only where bounces are unlimited.
constexpr float dim_throughput = 0.02F;
// Rays start this far off the surface, in tile units at coordinates around 1: about 40 float
// roundings.
constexpr float offset_from_surface = 3e-6F;

struct Path {
  Rgb throughput;
  Vec3 direction;  // of the ray that arrives
  std::uint32_t primitive;
  float u, v;
  std::uint16_t texel;  // within the block
  std::uint32_t sample;
};

// Where a path has arrived; z of the frame is the shading normal on the viewer's side.
struct Vertex {
  Vec3 origin;  // of rays that leave, off the surface
  Vec3 facet_normal;
  Frame frame;
  Direction view;  // in the frame
  std::uint16_t material;
};

float fraction(float x) {
  const float f = x - std::floor(x);
  return f < 1 ? f : 0;
}

}  // namespace

TraceStatistics& TraceStatistics::operator+=(const TraceStatistics& other) {
  paths += other.paths;
  primary_rays += other.primary_rays;
  bounce_rays += other.bounce_rays;
  shadow_rays += other.shadow_rays;
  rays_traced_on += other.rays_traced_on;
  missed += other.missed;
  degenerate += other.degenerate;
  trapped += other.trapped;
  return *this;
}

void check_elevations(std::span<const Direction> directions, const std::string& role) {
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double theta = degrees(theta_of(directions[i]));
    if (theta > lowest_theta + 1e-3) {
      throw bad_input(
          fmt::format("{} {}", role, i),
          fmt::format("is at theta {:.3f} degrees; expected at most {}", theta, lowest_theta));
    }
  }
}

ViewTracer::ViewTracer(Mesostructure mesostructure, std::vector<Direction> lights,
                       TraceSettings settings)
    : mesostructure_(std::move(mesostructure)),
      lights_(std::move(lights)),
      settings_(settings),
      scene_(mesostructure_.mesh) {
  check_elevations(lights_, "light");
  if (settings_.spp < 1)
    throw bad_input("--spp", fmt::format("is {}; expected at least 1", settings_.spp));
  if (settings_.width < 1 || settings_.height < 1) {
    throw bad_input("--texels", fmt::format("is {} x {}; expected at least 1", settings_.width,
                                            settings_.height));
  }
  if (settings_.max_bounces < 0) {
    throw bad_input("--max-bounces",
                    fmt::format("is {}; expected at least 0", settings_.max_bounces));
  }
}

// The paths of one block of texels, traced wave by wave. Holds its memory between blocks.
class ViewTracer::Block {
 public:
  explicit Block(const ViewTracer& tracer)
      : tracer_(tracer),
        n_lights_(tracer.lights_.size()),
        local_lights_(n_lights_),
        values_(n_lights_),
        contributions_(3 * group_size * n_lights_),
        sums_(static_cast<std::size_t>(3 * block_edge * block_edge) * n_lights_),
        group_sums_(error_groups * n_lights_) {
    shadow_rays_.resize(group_size * lights_at_once);
    shadow_owners_.resize(group_size * lights_at_once);
  }

  void trace(const Direction& view, std::uint64_t view_key, int left, int top) {
    std::fill(sums_.begin(), sums_.end(), 0.0);
    std::fill(group_sums_.begin(), group_sums_.end(), 0.0);
    statistics_ = {};
    view_ = view;
    view_key_ = view_key;
    left_ = left;
    top_ = top;
    const int spp = tracer_.settings_.spp;
    for (int first = 0; first < spp; first += samples_at_once) {
      start_paths(first, std::min(first + samples_at_once, spp));
      follow_paths();
    }
  }

  /// Sum over the samples, of a texel of the block and a light.
  Imath::V3d sum(std::size_t texel, std::size_t light) const {
    const double* p = &sums_[3 * (texel * n_lights_ + light)];
    return {p[0], p[1], p[2]};
  }
  const std::vector<double>& group_sums() const { return group_sums_; }
  const TraceStatistics& statistics() const { return statistics_; }

 private:
  std::uint64_t texel_number(std::size_t texel) const {
    const auto x = static_cast<std::uint64_t>(left_) + texel % block_edge;
    const auto y = static_cast<std::uint64_t>(top_) + texel / block_edge;
    return y * static_cast<std::uint64_t>(tracer_.settings_.width) + x;
  }

  // Two numbers of a pair of dimensions, for a path.
  std::array<float, 2> random(const Path& path, std::uint64_t pair) const {
    return sobol_point(path.sample, hash_coordinates(tracer_.settings_.seed, view_key_,
                                                     texel_number(path.texel), pair));
  }

  void start_paths(int first_sample, int end_sample) {
    const TraceSettings& s = tracer_.settings_;
    paths_.clear();
    for (int y = 0; y < std::min(block_edge, s.height - top_); ++y) {
      for (int x = 0; x < std::min(block_edge, s.width - left_); ++x) {
        for (int sample = first_sample; sample < end_sample; ++sample) {
          paths_.push_back({Rgb(1, 1, 1), -view_, 0, 0, 0,
                            static_cast<std::uint16_t>(y * block_edge + x),
                            static_cast<std::uint32_t>(sample)});
        }
      }
    }
    rays_.resize(std::max(rays_.size(), paths_.size()));
    const PeriodicScene& scene = tracer_.scene_;
    const float start = scene.top() + 1e-3F * std::max(1.0F, std::abs(scene.top()));
    const float back = (start - tracer_.mesostructure_.reference_height) / view_.z;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      const auto [u, v] = random(paths_[i], 0);
      const std::size_t texel = paths_[i].texel;
      const float px = (static_cast<float>(left_ + static_cast<int>(texel % block_edge)) + u) /
                       static_cast<float>(s.width);
      const float py = 1 - (static_cast<float>(top_ + static_cast<int>(texel / block_edge)) + v) /
                               static_cast<float>(s.height);
      const Vec3 origin(fraction(px + view_.x * back), fraction(py + view_.y * back), start);
      rays_.set(i, origin, -view_, 0, 0);
    }
    statistics_.paths += static_cast<std::int64_t>(paths_.size());
    statistics_.primary_rays += static_cast<std::int64_t>(paths_.size());
    const std::size_t started = paths_.size();
    keep_hits(Coherence::coherent);
    statistics_.missed += static_cast<std::int64_t>(started - paths_.size());
  }

  // Traces the rays of all paths and drops the paths that escape.
  void keep_hits(Coherence coherence) {
    statistics_.rays_traced_on += tracer_.scene_.intersect(rays_, paths_.size(), coherence);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (rays_.mesh[i] == RayHit::none) continue;
      Path path = paths_[i];
      path.primitive = rays_.primitive[i];
      path.u = rays_.u[i];
      path.v = rays_.v[i];
      paths_[kept++] = path;
    }
    paths_.resize(kept);
  }

  void follow_paths() {
    const int most = std::min(tracer_.settings_.max_bounces, most_bounces);
    for (int bounce = 0; !paths_.empty(); ++bounce) {
      const Coherence coherence = bounce == 0 ? Coherence::coherent : Coherence::incoherent;
      const bool last = bounce >= most;
      next_.clear();
      for (std::size_t begin = 0; begin < paths_.size(); begin += group_size) {
        const std::size_t end = std::min(begin + group_size, paths_.size());
        connect(begin, end, coherence);
        if (!last) scatter(begin, end, bounce);
      }
      if (last) {
        if (most == most_bounces) statistics_.trapped += static_cast<std::int64_t>(paths_.size());
        break;
      }
      std::swap(paths_, next_);
      for (std::size_t i = 0; i < paths_.size(); ++i) {
        rays_.set(i, origins_[i], paths_[i].direction, 0, 0);
      }
      origins_.clear();
      statistics_.bounce_rays += static_cast<std::int64_t>(paths_.size());
      keep_hits(Coherence::incoherent);
    }
    paths_.clear();
  }

  Vertex vertex_of(const Path& path) const {
    const TriangleMesh& mesh = tracer_.mesostructure_.mesh;
    const auto& [a, b, c] = mesh.triangles[path.primitive];
    const Vec3 e1 = mesh.positions[b] - mesh.positions[a];
    const Vec3 e2 = mesh.positions[c] - mesh.positions[a];
    Vec3 facet = e1 % e2;
    const float length = facet.length();
    Vertex vertex;
    vertex.material = mesh.materials[path.primitive];
    if (!(length > 0)) {
      vertex.facet_normal = Vec3(0, 0, 0);
      return vertex;
    }
    facet /= length;
    Vec3 shading = facet;
    if (!mesh.normals.empty()) {
      shading = (mesh.normals[a] * (1 - path.u - path.v) + mesh.normals[b] * path.u +
                 mesh.normals[c] * path.v)
                    .normalized();
    }
    if ((facet ^ path.direction) > 0) {
      facet = -facet;
      shading = -shading;
    }
    // A shading normal that faces away from the viewer has nothing to say: the facet's own is used.
    if (!((shading ^ path.direction) < -1e-4F)) shading = facet;
    Vec3 p = mesh.positions[a] + e1 * path.u + e2 * path.v;
    p.x = fraction(p.x);
    p.y = fraction(p.y);
    vertex.origin = p + facet * (offset_from_surface * std::max(1.0F, std::abs(p.z)));
    vertex.origin.x = fraction(vertex.origin.x);
    vertex.origin.y = fraction(vertex.origin.y);
    vertex.facet_normal = facet;
    vertex.frame = frame_around(shading);
    vertex.view = vertex.frame.to_local(-path.direction);
    return vertex;
  }

  // Adds the light that the vertices of paths [begin, end) reflect directly, from every light.
  void connect(std::size_t begin, std::size_t end, Coherence coherence) {
    for (std::size_t i = begin; i < end; ++i) {
      vertices_[i - begin] = vertex_of(paths_[i]);
      reflect_lights(paths_[i], vertices_[i - begin], &contributions_[3 * (i - begin) * n_lights_]);
    }
    for (std::size_t l = 0; l < n_lights_; l += lights_at_once) {
      add_unoccluded(begin, end, l, std::min(l + lights_at_once, n_lights_), coherence);
    }
  }

  // Traces the shadow rays of paths [begin, end) to lights [first, last), light by light, and adds
  // what arrives.
  void add_unoccluded(std::size_t begin, std::size_t end, std::size_t first, std::size_t last,
                      Coherence coherence) {
    std::size_t count = 0;
    for (std::size_t l = first; l < last; ++l) {
      for (std::size_t k = 0; k < end - begin; ++k) {
        const float* value = &contributions_[3 * (k * n_lights_ + l)];
        if (value[0] + value[1] + value[2] > 0) {
          shadow_rays_.set(count, vertices_[k].origin, tracer_.lights_[l], 0, 0);
          shadow_owners_[count++] = {static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(l)};
        }
      }
    }
    statistics_.shadow_rays += static_cast<std::int64_t>(count);
    statistics_.rays_traced_on += tracer_.scene_.occluded(shadow_rays_, count, coherence);
    for (std::size_t r = 0; r < count; ++r) {
      if (shadow_rays_.tfar[r] < 0) continue;
      const auto [k, l] = shadow_owners_[r];
      const Path& path = paths_[begin + k];
      const float* value = &contributions_[3 * (k * n_lights_ + l)];
      double* sum = &sums_[3 * (path.texel * n_lights_ + l)];
      for (int c = 0; c < 3; ++c) sum[c] += value[c];
      group_sums_[(path.sample % error_groups) * n_lights_ + l] +=
          (static_cast<double>(value[0]) + value[1] + value[2]) / 3;
    }
  }

  // throughput * f * cos for every light; 0 for those behind the facet. `out`: [light][rgb].
  void reflect_lights(const Path& path, const Vertex& vertex, float* out) {
    if (vertex.facet_normal == Vec3(0, 0, 0)) {
      ++statistics_.degenerate;
      std::fill_n(out, 3 * n_lights_, 0.0F);
      return;
    }
    for (std::size_t l = 0; l < n_lights_; ++l) {
      const Direction local = vertex.frame.to_local(tracer_.lights_[l]);
      local_lights_.x[l] = local.x;
      local_lights_.y[l] = local.y;
      local_lights_.z[l] = (vertex.facet_normal ^ tracer_.lights_[l]) > 0 ? local.z : 0;
    }
    const Bsdf& bsdf = tracer_.mesostructure_.materials[vertex.material];
    evaluate_lights(bsdf, local_lights_, vertex.view, values_);
    for (std::size_t l = 0; l < n_lights_; ++l) {
      out[3 * l] = values_.r[l] * path.throughput.x;
      out[3 * l + 1] = values_.g[l] * path.throughput.y;
      out[3 * l + 2] = values_.b[l] * path.throughput.z;
    }
  }

  // Draws where paths [begin, end), whose vertices are known, go on.
  void scatter(std::size_t begin, std::size_t end, int bounce) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vertex& vertex = vertices_[i - begin];
      if (vertex.facet_normal == Vec3(0, 0, 0)) continue;
      Path path = paths_[i];
      const auto pair = static_cast<std::uint64_t>(2 * bounce + 1);
      const auto [u, v] = random(path, pair);
      const auto [lobe, roulette] = random(path, pair + 1);
      const Bsdf::Sample sample =
          tracer_.mesostructure_.materials[vertex.material].sample(vertex.view, {lobe, u, v});
      if (!(sample.pdf > 0)) continue;
      path.direction = vertex.frame.to_world(sample.light).normalized();
      if (!((path.direction ^ vertex.facet_normal) > 0)) continue;
      path.throughput *= sample.weight;
      const float brightness = max_component(path.throughput);
      if (brightness < dim_throughput) {
        if (!(roulette * dim_throughput < brightness)) continue;
        path.throughput *= dim_throughput / brightness;
      }
      next_.push_back(path);
      origins_.push_back(vertex.origin);
    }
  }

  const ViewTracer& tracer_;
  std::size_t n_lights_;
  Direction view_;
  std::uint64_t view_key_ = 0;
  int left_ = 0;
  int top_ = 0;
  std::vector<Path> paths_;
  std::vector<Path> next_;
  std::vector<Vec3> origins_;
  RayStream rays_;
  std::array<Vertex, group_size> vertices_;
  LightBatch local_lights_;
  RgbBatch values_;
  std::vector<float> contributions_;  // [path of the group][light][rgb]
  RayStream shadow_rays_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> shadow_owners_;  // path of the group, light
  std::vector<double> sums_;                                            // [texel][light][rgb]
  std::vector<double> group_sums_;                                      // [group of samples][light]
  TraceStatistics statistics_;
};

namespace {

// From the sums of groups of samples over the whole tile: the spread of their means.
std::vector<float> standard_errors(const std::vector<double>& group_sums, std::size_t n_lights,
                                   int spp, double texels) {
  if (spp < 2) return {};
  const int groups = std::min(error_groups, spp);
  std::vector<float> errors(n_lights);
  for (std::size_t l = 0; l < n_lights; ++l) {
    double sum = 0;
    double sum_of_squares = 0;
    for (int g = 0; g < groups; ++g) {
      const int samples = spp / error_groups + (g < spp % error_groups ? 1 : 0);
      const double mean =
          group_sums[static_cast<std::size_t>(g) * n_lights + l] / (samples * texels);
      sum += mean;
      sum_of_squares += mean * mean;
    }
    const double variance = std::max(0.0, sum_of_squares - sum * sum / groups) / (groups - 1);
    errors[l] = static_cast<float>(std::sqrt(variance / groups));
  }
  return errors;
}

}  // namespace

TracedView ViewTracer::trace(const Direction& view, std::uint64_t view_key) const {
  check_elevations({&view, 1}, "view");
  const int columns = (settings_.width + block_edge - 1) / block_edge;
  const int rows = (settings_.height + block_edge - 1) / block_edge;
  const std::size_t texels = static_cast<std::size_t>(settings_.width) * settings_.height;
  const auto blocks = static_cast<std::size_t>(columns) * rows;
  TracedView traced;
  traced.values.resize(3 * lights_.size() * texels);
  std::vector<std::vector<double>> group_sums(blocks);
  std::vector<TraceStatistics> statistics(blocks);
  tbb::enumerable_thread_specific<Block> workers([&] { return Block(*this); });
  const auto trace_block = [&](std::size_t b) {
    Block& block = workers.local();
    const int left = static_cast<int>(b) % columns * block_edge;
    const int top = static_cast<int>(b) / columns * block_edge;
    block.trace(view, view_key, left, top);
    for (int y = top; y < std::min(top + block_edge, settings_.height); ++y) {
      for (int x = left; x < std::min(left + block_edge, settings_.width); ++x) {
        const auto texel = static_cast<std::size_t>((y - top) * block_edge + x - left);
        for (std::size_t l = 0; l < lights_.size(); ++l) {
          const Imath::V3d mean = block.sum(texel, l) / settings_.spp;
          float* out =
              &traced.values[3 * (l * texels + static_cast<std::size_t>(y) * settings_.width + x)];
          for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(mean[c]);
        }
      }
    }
    group_sums[b] = block.group_sums();
    statistics[b] = block.statistics();
  };
  // Isolated: a thread that waits here must not begin another view, whose memory would come on top.
  tbb::this_task_arena::isolate([&] { tbb::parallel_for(std::size_t{0}, blocks, trace_block); });
  std::vector<double> sums(error_groups * lights_.size());
  for (std::size_t b = 0; b < blocks; ++b) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += group_sums[b][i];
    traced.statistics += statistics[b];
  }
  traced.standard_errors =
      standard_errors(sums, lights_.size(), settings_.spp, static_cast<double>(texels));
  return traced;
}

}  // namespace weft
