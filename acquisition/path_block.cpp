#include "acquisition/path_block.h"

#include <algorithm>
#include <cmath>

#include "tracer/sobol.h"

namespace weft {

namespace {

constexpr int samples_at_once = 64;  // of each texel in a block
// Shadow rays of a group to this many lights go to Embree in one stream, which stays in the cache.
constexpr std::size_t lights_at_once = 16;
// A path of a closed, white inside (a ray that slipped between touching surfaces) would never end.
constexpr int most_bounces = 4096;
// Paths dimmer than this are ended by Russian roulette; needed only where bounces are unlimited.
constexpr float dim_throughput = 0.02F;
// Rays start this far off the surface, at coordinates around 1: about 40 float roundings.
constexpr float offset_from_surface = 3e-6F;

}  // namespace

PathBlock::PathBlock(const ViewTracer& tracer)
    : tracer_(tracer),
      n_lights_(tracer.lights().size()),
      contributions_(3 * group_size * n_lights_),
      sums_(static_cast<std::size_t>(3 * edge * edge) * n_lights_),
      group_sums_(error_groups * n_lights_) {
  shadow_rays_.resize(group_size * lights_at_once);
  shadow_owners_.resize(group_size * lights_at_once);
}

void PathBlock::trace(const Direction& view, std::uint64_t view_key, int left, int top) {
  std::fill(sums_.begin(), sums_.end(), 0.0);
  std::fill(group_sums_.begin(), group_sums_.end(), 0.0);
  statistics_ = {};
  view_ = view;
  view_key_ = view_key;
  left_ = left;
  top_ = top;
  const int spp = tracer_.settings().spp;
  for (int first = 0; first < spp; first += samples_at_once) {
    start_paths(first, std::min(first + samples_at_once, spp));
    follow_paths();
  }
}

std::uint64_t PathBlock::texel_number(std::size_t texel) const {
  const auto x = static_cast<std::uint64_t>(left_) + texel % edge;
  const auto y = static_cast<std::uint64_t>(top_) + texel / edge;
  return y * static_cast<std::uint64_t>(tracer_.settings().width) + x;
}

std::array<float, 2> PathBlock::random(const Path& path, std::uint64_t pair) const {
  return sobol_point(path.sample, hash_coordinates(tracer_.settings().seed, view_key_,
                                                   texel_number(path.texel), pair));
}

void PathBlock::start_paths(int first_sample, int end_sample) {
  const TraceSettings& s = tracer_.settings();
  paths_.clear();
  for (int y = 0; y < std::min(edge, s.height - top_); ++y) {
    for (int x = 0; x < std::min(edge, s.width - left_); ++x) {
      for (int sample = first_sample; sample < end_sample; ++sample) {
        paths_.push_back({Rgb(1, 1, 1), -view_, 0, 0, 0, static_cast<std::uint16_t>(y * edge + x),
                          static_cast<std::uint32_t>(sample)});
      }
    }
  }
  rays_.resize(std::max(rays_.size(), paths_.size()));
  const PeriodicScene& scene = tracer_.scene();
  const float start = scene.top() + 1e-3F * std::max(1.0F, std::abs(scene.top()));
  const float back = (start - tracer_.mesostructure().reference_height) / view_.z;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const auto [u, v] = random(paths_[i], 0);
    const std::size_t texel = paths_[i].texel;
    const float px = (static_cast<float>(left_ + static_cast<int>(texel % edge)) + u) /
                     static_cast<float>(s.width);
    const float py = 1 - (static_cast<float>(top_ + static_cast<int>(texel / edge)) + v) /
                             static_cast<float>(s.height);
    const Vec3 origin(tile_fraction(px + view_.x * back), tile_fraction(py + view_.y * back),
                      start);
    rays_.set(i, origin, -view_, 0, 0);
  }
  statistics_.paths += static_cast<std::int64_t>(paths_.size());
  statistics_.primary_rays += static_cast<std::int64_t>(paths_.size());
  const std::size_t started = paths_.size();
  keep_hits(Coherence::coherent);
  statistics_.missed += static_cast<std::int64_t>(started - paths_.size());
}

void PathBlock::keep_hits(Coherence coherence) {
  statistics_.rays_traced_on += tracer_.scene().intersect(rays_, paths_.size(), coherence);
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

void PathBlock::follow_paths() {
  const int most = std::min(tracer_.settings().max_bounces, most_bounces);
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
      if (tracer_.settings().max_bounces == TraceSettings::unlimited)
        statistics_.trapped += static_cast<std::int64_t>(paths_.size());
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

PathBlock::Vertex PathBlock::vertex_of(const Path& path) const {
  const TriangleMesh& mesh = tracer_.mesostructure().mesh;
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
  const float largest = std::max({1.0F, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  p.x = tile_fraction(p.x);
  p.y = tile_fraction(p.y);
  vertex.origin = p + facet * (offset_from_surface * largest);
  vertex.origin.x = tile_fraction(vertex.origin.x);
  vertex.origin.y = tile_fraction(vertex.origin.y);
  vertex.facet_normal = facet;
  vertex.frame = frame_around(shading);
  vertex.view = vertex.frame.to_local(-path.direction);
  return vertex;
}

void PathBlock::connect(std::size_t begin, std::size_t end, Coherence coherence) {
  for (std::size_t i = begin; i < end; ++i) {
    vertices_[i - begin] = vertex_of(paths_[i]);
    reflect_lights(paths_[i], vertices_[i - begin],
                   std::span(contributions_).subspan(3 * (i - begin) * n_lights_, 3 * n_lights_));
  }
  for (std::size_t l = 0; l < n_lights_; l += lights_at_once) {
    add_unoccluded(begin, end, l, std::min(l + lights_at_once, n_lights_), coherence);
  }
}

void PathBlock::add_unoccluded(std::size_t begin, std::size_t end, std::size_t first,
                               std::size_t last, Coherence coherence) {
  std::size_t count = 0;
  for (std::size_t l = first; l < last; ++l) {
    for (std::size_t k = 0; k < end - begin; ++k) {
      const float* value = &contributions_[3 * (k * n_lights_ + l)];
      // A value that is not a number goes on, to be refused where the view is stored.
      if (!(value[0] + value[1] + value[2] <= 0)) {
        shadow_rays_.set(count, vertices_[k].origin, tracer_.lights()[l], 0, 0);
        shadow_owners_[count++] = {static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(l)};
      }
    }
  }
  statistics_.shadow_rays += static_cast<std::int64_t>(count);
  statistics_.rays_traced_on += tracer_.scene().occluded(shadow_rays_, count, coherence);
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

void PathBlock::reflect_lights(const Path& path, const Vertex& vertex,
                               std::span<float> contributions) {
  if (vertex.facet_normal == Vec3(0, 0, 0)) {
    ++statistics_.degenerate;
    std::fill(contributions.begin(), contributions.end(), 0.0F);
    return;
  }
  const Bsdf& bsdf = tracer_.mesostructure().materials[vertex.material];
  for (std::size_t l = 0; l < n_lights_; ++l) {
    const Direction& light = tracer_.lights()[l];
    Rgb value(0, 0, 0);
    if ((vertex.facet_normal ^ light) > 0) {
      value = bsdf.evaluate(vertex.frame.to_local(light), vertex.view) * path.throughput;
    }
    std::copy_n(&value.x, 3, contributions.begin() + static_cast<std::ptrdiff_t>(3 * l));
  }
}

void PathBlock::scatter(std::size_t begin, std::size_t end, int bounce) {
  for (std::size_t i = begin; i < end; ++i) {
    const Vertex& vertex = vertices_[i - begin];
    if (vertex.facet_normal == Vec3(0, 0, 0)) continue;
    Path path = paths_[i];
    const std::uint64_t pair = 2 * static_cast<std::uint64_t>(bounce) + 1;
    const auto [u, v] = random(path, pair);
    const auto [lobe, roulette] = random(path, pair + 1);
    const Bsdf::Sample sample =
        tracer_.mesostructure().materials[vertex.material].sample(vertex.view, {lobe, u, v});
    if (std::isnan(sample.pdf)) ++statistics_.invalid;
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

}  // namespace weft
