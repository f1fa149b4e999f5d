#include "tracer/integrator.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "btf/random.h"
#include "tracer/frame.h"
#include "tracer/sobol.h"

namespace weft {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float pi = std::numbers::pi_v<float>;
// What a path asks random numbers for at each depth; each further environment has a number of its
// own.
constexpr int filter_purpose = 0;
constexpr int bounce_purpose = 1;
constexpr int end_purpose = 2;  ///< whether the path ends, and the lobe of the bounce
constexpr int environment_purpose = 3;
/// A bounced footprint widens by this much a unit of way; see RenderSettings::lod.
constexpr float bounce_spread = 0.25F;
/// From this depth on paths are ended at random in proportion to what they still carry.
constexpr int roulette_depth = 4;
constexpr float longest_survival = 0.95F;

/// Of what `cosine_direction` draws.
float cosine_pdf(const Direction& light) {
  return light.z / pi;
}

bool is_finite(const Rgb& c) {
  return std::isfinite(c.x + c.y + c.z);
}

float largest_magnitude(const Rgb& c) {
  return std::max({std::abs(c.x), std::abs(c.y), std::abs(c.z)});
}

/// Where a step of the ray's direction moves the point that it meets in the plane with normal
/// `normal`.
Vec3 step_in_plane(const CameraRay& ray, float distance, const Vec3& direction_step,
                   const Vec3& normal) {
  const Vec3 step = direction_step * distance;
  const float cosine = ray.direction.dot(normal);
  return cosine == 0 ? step : step - ray.direction * (step.dot(normal) / cosine);
}

}  // namespace

PathBatch::PathBatch(const TracedScene& scene, const RenderSettings& settings)
    : scene_(scene),
      settings_(settings),
      max_bounces_(settings.integrator == Integrator::direct ? 0 : settings.max_bounces),
      combine_(settings.shadows && !scene.environments.empty()),
      queries_(scene.scene.materials.size()),
      query_requests_(scene.scene.materials.size()) {}

/// Two random numbers for one purpose of a path; well spread over the pixel's samples.
std::array<float, 2> PathBatch::random(const Path& path, int depth, int purpose) const {
  const std::int64_t pixel = static_cast<std::int64_t>(path.y) * scene_.camera.width() + path.x;
  return sobol_point(static_cast<std::uint32_t>(path.sample),
                     hash_coordinates(settings_.seed, pixel, depth, purpose));
}

void PathBatch::trace(int x0, int y0, int x1, int y1, int first_sample, int last_sample,
                      Film& film) {
  start(x0, y0, x1, y1, first_sample, last_sample);
  for (int depth = 0; !active_.empty(); ++depth) {
    intersect(depth);
    if (depth > max_bounces_) break;  // this ray only looked for environments
    requests_.clear();
    distances_.clear();
    request_lights();
    request_environments(depth);
    light_requests_ = requests_.size();
    if (depth < max_bounces_ || combine_) request_bounces(depth);
    evaluate();
    add_light();
    continue_paths(depth);
  }
  for (const Path& path : paths_) film.add(path.x, path.y, path.radiance);
}

void PathBatch::start(int x0, int y0, int x1, int y1, int first_sample, int last_sample) {
  paths_.clear();
  active_.clear();
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      for (int sample = first_sample; sample < last_sample; ++sample) {
        Path path;
        path.x = x;
        path.y = y;
        path.sample = sample;
        const auto [u0, u1] = random(path, 0, filter_purpose);
        const auto [dx, dy] = filter_offset(settings_.filter, u0, u1);
        path.ray = scene_.camera.ray(x + dx, y + dy);
        active_.push_back(paths_.size());
        paths_.push_back(path);
      }
    }
  }
}

/// Nearest hits of the active paths' rays; misses are lit by the environments and end.
void PathBatch::intersect(int depth) {
  ray_stream_.resize(std::max(ray_stream_.size(), active_.size()));
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const CameraRay& ray = paths_[active_[i]].ray;
    ray_stream_.set(i, ray.origin, ray.direction, 0, infinity);
  }
  scene_.rays.intersect(ray_stream_, active_.size(),
                        depth == 0 ? Coherence::coherent : Coherence::incoherent);
  ray_count_ += static_cast<std::int64_t>(active_.size());

  hits_.clear();
  hit_paths_.clear();
  for (std::size_t i = 0; i < active_.size(); ++i) {
    Path& path = paths_[active_[i]];
    const RayHit hit{ray_stream_.tfar[i], ray_stream_.u[i], ray_stream_.v[i], ray_stream_.mesh[i],
                     ray_stream_.primitive[i]};
    if (!hit.hit()) {
      if (depth == 0 || combine_) add_environments(path, depth);
    } else if (depth <= max_bounces_) {
      const SurfaceHit surface = make_hit(path, hit, depth);
      if (!(surface.view.z > 0)) continue;  // the back is black
      hits_.push_back(surface);
      hit_paths_.push_back(active_[i]);
    }
  }
}

void PathBatch::add_environments(Path& path, int depth) const {
  for (const EnvironmentSampler& environment : scene_.environments) {
    float weight = 1;
    if (depth > 0) weight = path.pdf / (path.pdf + environment.pdf(path.ray.direction));
    path.radiance += path.throughput * environment.radiance(path.ray.direction) * weight;
  }
}

SurfaceHit PathBatch::make_hit(Path& path, const RayHit& hit, int depth) const {
  const SceneShape& shape = scene_.scene.shapes[hit.mesh];
  const SceneMaterial& material = scene_.scene.materials[shape.material];
  SurfaceHit surface = surface_hit(shape, material, hit, path.ray.direction);
  if (settings_.lod) {
    surface.lod = *settings_.lod;
    return surface;
  }
  if (!material.appearance->has_lod() && max_bounces_ == 0) return surface;
  const TexelGradient gradient(shape, material, hit);
  if (depth == 0) {
    const Vec3& normal = surface.geometric_normal;
    const Vec3 dx = step_in_plane(path.ray, hit.distance, path.ray.direction_dx, normal);
    const Vec3 dy = step_in_plane(path.ray, hit.distance, path.ray.direction_dy, normal);
    path.width = std::max(dx.length(), dy.length());
    surface.lod = lod_of_width(std::max(gradient.texels(dx), gradient.texels(dy)));
  } else {
    path.width += bounce_spread * hit.distance;
    surface.lod = lod_of_width(gradient.texels(path.width));
  }
  return surface;
}

/// @param irradiance  perpendicular to `direction`, were nothing in the way.
void PathBatch::request_light(std::size_t hit, const Vec3& direction, float distance,
                              const Rgb& irradiance) {
  const SurfaceHit& surface = hits_[hit];
  const Direction light = surface.to_local(direction);
  if (!(light.z > 0)) return;
  // Behind the triangle itself, though not behind its interpolated normal.
  if (settings_.shadows && !(surface.geometric_normal.dot(direction) > 0)) return;
  requests_.push_back({hit, irradiance, light, 0});
  distances_.push_back(distance);
}

void PathBatch::request_lights() {
  for (const DirectionalLight& light : scene_.scene.directional_lights) {
    for (std::size_t i = 0; i < hits_.size(); ++i)
      request_light(i, light.direction, infinity, light.irradiance);
  }
  for (const PointLight& light : scene_.scene.point_lights) {
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const Vec3 way = light.position - hits_[i].position;
      const float distance2 = way.length2();
      request_light(i, way.normalized(), std::sqrt(distance2), light.intensity / distance2);
    }
  }
  remove_shadowed(0, Coherence::coherent);
}

void PathBatch::request_environments(int depth) {
  const std::size_t first = requests_.size();
  for (std::size_t e = 0; e < scene_.environments.size(); ++e) {
    for (std::size_t i = 0; i < hits_.size(); ++i) {
      const Path& path = paths_[hit_paths_[i]];
      const auto [u0, u1] = random(path, depth, environment_purpose + static_cast<int>(e));
      const EnvironmentSampler::Sample sample = scene_.environments[e].sample(u0, u1);
      if (!(sample.pdf > 0)) continue;
      const float other =
          combine_ ? bounce_pdf(hits_[i], hits_[i].to_local(sample.direction)) : 0.0F;
      request_light(i, sample.direction, infinity, sample.radiance / (sample.pdf + other));
    }
  }
  remove_shadowed(first, Coherence::incoherent);
}

/// Drops the requests from `first` on whose light does not arrive.
void PathBatch::remove_shadowed(std::size_t first, Coherence coherence) {
  const std::size_t count = requests_.size() - first;
  if (!settings_.shadows || count == 0) return;
  ray_stream_.resize(std::max(ray_stream_.size(), count));
  for (std::size_t i = 0; i < count; ++i) {
    const SurfaceHit& surface = hits_[requests_[first + i].hit];
    ray_stream_.set(i, surface.origin(), surface.to_world(requests_[first + i].light), 0,
                    distances_[first + i]);
  }
  scene_.rays.occluded(ray_stream_, count, coherence);
  ray_count_ += static_cast<std::int64_t>(count);
  std::size_t kept = first;
  for (std::size_t i = 0; i < count; ++i) {
    if (ray_stream_.tfar[i] < 0) continue;
    requests_[kept++] = requests_[first + i];
  }
  requests_.resize(kept);
  distances_.resize(kept);
}

/// One a hit.
void PathBatch::request_bounces(int depth) {
  for (std::size_t i = 0; i < hits_.size(); ++i) requests_.push_back(bounce(i, depth));
}

PathBatch::Request PathBatch::bounce(std::size_t hit, int depth) const {
  const SurfaceHit& surface = hits_[hit];
  const Path& path = paths_[hit_paths_[hit]];
  const auto [u0, u1] = random(path, depth, bounce_purpose);
  if (const auto& bsdf = scene_.scene.materials[surface.material].bsdf) {
    const float lobe = random(path, depth, end_purpose)[1];
    const Bsdf::Sample sample = bsdf->sample(surface.view, {lobe, u0, u1});
    return {hit, {0, 0, 0}, sample.light, sample.pdf};
  }
  const Direction light = cosine_direction(u0, u1);
  return {hit, {0, 0, 0}, light, cosine_pdf(light)};
}

/// Density of `bounce` at `light`, per sr.
float PathBatch::bounce_pdf(const SurfaceHit& surface, const Direction& light) const {
  if (!(light.z > 0)) return 0;
  const auto& bsdf = scene_.scene.materials[surface.material].bsdf;
  return bsdf ? bsdf->pdf(light, surface.view) : cosine_pdf(light);
}

/// Asks each material for all its requests at once.
void PathBatch::evaluate() {
  for (std::size_t m = 0; m < queries_.size(); ++m) {
    queries_[m].clear();
    query_requests_[m].clear();
  }
  for (std::size_t r = 0; r < requests_.size(); ++r) {
    const SurfaceHit& surface = hits_[requests_[r].hit];
    queries_[surface.material].push_back(
        {surface.uv, requests_[r].light, surface.view, surface.lod});
    query_requests_[surface.material].push_back(r);
  }
  answers_.resize(requests_.size());
  for (std::size_t m = 0; m < queries_.size(); ++m) {
    if (queries_[m].empty()) continue;
    material_answers_.resize(queries_[m].size());
    scene_.scene.materials[m].appearance->evaluate(queries_[m], material_answers_);
    for (std::size_t q = 0; q < queries_[m].size(); ++q)
      answers_[query_requests_[m][q]] = material_answers_[q];
  }
  evaluation_count_ += static_cast<std::int64_t>(requests_.size());
}

void PathBatch::add_light() {
  for (std::size_t r = 0; r < light_requests_; ++r) {
    Path& path = paths_[hit_paths_[requests_[r].hit]];
    path.radiance += path.throughput * answers_[r] * requests_[r].weight;
  }
}

void PathBatch::continue_paths(int depth) {
  active_.clear();
  for (std::size_t r = light_requests_; r < requests_.size(); ++r) {
    const SurfaceHit& surface = hits_[requests_[r].hit];
    Path& path = paths_[hit_paths_[requests_[r].hit]];
    path.pdf = requests_[r].pdf;
    if (!(path.pdf > 0)) continue;
    path.throughput *= answers_[r] / path.pdf;
    if (!is_finite(path.throughput)) {  // shows in the film's count
      path.radiance = path.throughput;
      continue;
    }
    if (depth >= roulette_depth) {
      const float survival = std::min(longest_survival, largest_magnitude(path.throughput));
      if (random(path, depth, end_purpose)[0] >= survival) continue;
      path.throughput /= survival;
    }
    const Vec3 direction = surface.to_world(requests_[r].light).normalized();
    // Into the triangle's back, though not behind its interpolated normal: no light comes from
    // there.
    if (largest_magnitude(path.throughput) == 0 || !(surface.geometric_normal.dot(direction) > 0))
      continue;
    path.ray = {surface.origin(), direction, {0, 0, 0}, {0, 0, 0}};
    active_.push_back(hit_paths_[requests_[r].hit]);
  }
}

}  // namespace weft
