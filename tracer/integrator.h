// The path integrator: a batch of paths goes on together, bounce by bounce, so that rays are traced
// as streams and each appearance is asked once for all its points.
//
// At each hit every point and directional light is summed; each environment by one sample of its
// own and one of the surface's (its BSDF's own, or cosine-weighted for a BTF; it also goes on as
// the path), combined by the balance heuristic (Veach).
#pragma once

#include <array>
#include <vector>

#include "tracer/render.h"
#include "tracer/surface_hit.h"
#include "tracer/traced_scene.h"

namespace weft {

class PathBatch {
 public:
  PathBatch(const TracedScene& scene, const RenderSettings& settings);

  /// Traces samples [first_sample, last_sample) of the pixels in [x0, x1) x [y0, y1) and adds them
  /// to `film`.
  void trace(int x0, int y0, int x1, int y1, int first_sample, int last_sample, Film& film);

  std::int64_t rays() const { return ray_count_; }
  std::int64_t evaluations() const { return evaluation_count_; }

 private:
  struct Path {
    int x = 0;
    int y = 0;
    int sample = 0;
    Rgb throughput{1, 1, 1};
    Rgb radiance{0, 0, 0};
    float pdf = 0;    ///< of the last bounce's direction, per sr
    float width = 0;  ///< of the footprint at the last hit
    CameraRay ray;    ///< the next ray; its differentials only count for the first
  };
  /// A question about a hit and what its answer is worth.
  struct Request {
    std::size_t hit;
    Rgb weight;
    Direction light;
    float pdf = 0;  ///< of a bounce's direction, per sr
  };

  void start(int x0, int y0, int x1, int y1, int first_sample, int last_sample);
  void intersect(int depth);
  void add_environments(Path& path, int depth) const;
  SurfaceHit make_hit(Path& path, const RayHit& hit, int depth) const;
  void request_light(std::size_t hit, const Vec3& direction, float distance, const Rgb& irradiance);
  void request_lights();
  void request_environments(int depth);
  void remove_shadowed(std::size_t first, Coherence coherence);
  void request_bounces(int depth);
  Request bounce(std::size_t hit, int depth) const;
  float bounce_pdf(const SurfaceHit& surface, const Direction& light) const;
  void evaluate();
  void add_light();
  void continue_paths(int depth);
  std::array<float, 2> random(const Path& path, int depth, int purpose) const;

  const TracedScene& scene_;
  const RenderSettings& settings_;
  int max_bounces_;
  bool combine_;  ///< environments are sampled in both ways

  std::vector<Path> paths_;
  std::vector<std::size_t> active_;     ///< paths with a ray under way
  std::vector<std::size_t> hit_paths_;  ///< path of each hit
  std::vector<SurfaceHit> hits_;
  std::vector<Request> requests_;  ///< light first, then one bounce a hit
  std::size_t light_requests_ = 0;
  std::vector<float> distances_;  ///< to the light, a request
  std::vector<Rgb> answers_;
  RayStream ray_stream_;
  std::vector<std::vector<AppearanceQuery>> queries_;     ///< a material
  std::vector<std::vector<std::size_t>> query_requests_;  ///< whose they are
  std::vector<Rgb> material_answers_;
  std::int64_t ray_count_ = 0;
  std::int64_t evaluation_count_ = 0;
};

}  // namespace weft
