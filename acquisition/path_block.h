// The paths of one block of texels, traced wave by wave.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "acquisition/view_tracer.h"
#include "tracer/frame.h"

namespace weft {

/// Holds its memory between blocks; one a thread.
class PathBlock {
 public:
  static constexpr int edge = 8;  ///< texels
  static constexpr int error_groups =
      16;  ///< groups of samples whose spread gives the standard errors

  /// @param tracer  outlives the block.
  explicit PathBlock(const ViewTracer& tracer);

  /// Traces all samples of the texels from column `left` and row `top` on. What follows tells of
  /// the last call.
  void trace(const Direction& view, std::uint64_t view_key, int left, int top);

  /// Sum over the samples, of a texel of the block (row * edge + column) and a light.
  Imath::V3d sum(std::size_t texel, std::size_t light) const {
    const double* p = &sums_[3 * (texel * n_lights_ + light)];
    return {p[0], p[1], p[2]};
  }
  /// [group of samples][light]: sums of the mean of RGB over texels and samples.
  const std::vector<double>& group_sums() const { return group_sums_; }
  const TraceStatistics& statistics() const { return statistics_; }

 private:
  static constexpr std::size_t group_size = 64;  // paths that are connected to the lights together

  struct Path {
    Rgb throughput;
    Vec3 direction;  // of the ray that arrives
    std::uint32_t primitive;
    float u, v;
    std::uint16_t texel;  // within the block
    std::uint32_t sample;
  };

  // Where a path has arrived; z of the frame is the shading normal on the viewer's side. A triangle
  // without an area has no normal: it is zero.
  struct Vertex {
    Vec3 origin;  // of rays that leave, off the surface
    Vec3 facet_normal;
    Frame frame;
    Direction view;  // in the frame
    std::uint16_t material;
  };

  std::uint64_t texel_number(std::size_t texel) const;
  // Two numbers of a pair of dimensions, for a path.
  std::array<float, 2> random(const Path& path, std::uint64_t pair) const;
  void start_paths(int first_sample, int end_sample);
  // Traces the rays of all paths and drops the paths that escape.
  void keep_hits(Coherence coherence);
  void follow_paths();
  Vertex vertex_of(const Path& path) const;
  // Adds the light that the vertices of paths [begin, end) reflect directly, from every light.
  void connect(std::size_t begin, std::size_t end, Coherence coherence);
  // Traces the shadow rays of paths [begin, end) to lights [first, last), light by light, and adds
  // what arrives.
  void add_unoccluded(std::size_t begin, std::size_t end, std::size_t first, std::size_t last,
                      Coherence coherence);
  // Writes throughput * f * cos for every light, [light][rgb]; 0 for those behind the facet.
  void reflect_lights(const Path& path, const Vertex& vertex, std::span<float> contributions);
  // Draws where paths [begin, end), whose vertices are known, go on.
  void scatter(std::size_t begin, std::size_t end, int bounce);

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
  std::vector<float> contributions_;  // [path of the group][light][rgb]
  RayStream shadow_rays_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> shadow_owners_;  // path of the group, light
  std::vector<double> sums_;                                            // [texel][light][rgb]
  std::vector<double> group_sums_;
  TraceStatistics statistics_;
};

}  // namespace weft
