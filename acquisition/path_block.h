// The paths of one block of texels, traced wave by wave.
//
// A wave holds some samples of all the block's texels. Its paths meet the surface, are connected to
// every light at once, and go on together. Where the visibility table is certain, it
// answers for the light; one such answer in 256 is traced all the same, and where it was wrong, the
// difference is added 256 times: so the mean is that of tracing everything. The same goes for
// bounces that are certain to meet nothing, of which one in 4 or 16 is traced.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "acquisition/packet_log.h"
#include "acquisition/sample_points.h"
#include "acquisition/shadow_queue.h"
#include "acquisition/texel_sums.h"
#include "acquisition/view_tracer.h"
#include "tracer/frame.h"

namespace weft {

/// Holds its memory between blocks; one a thread.
class PathBlock {
 public:
  /// Texels a side of a block: fewer where the lights are many, so that the sums stay in the cache.
  static int edge_for(std::size_t lights);

  /// The square of that: the most texels, or cells, at once.
  static std::size_t texels_for(std::size_t lights);

  /// Memory of one block.
  static std::size_t bytes_for(std::size_t lights);

  /// @param tracer  outlives the block.
  /// @param log     gets a copy of every packet before it is traced; none where null.
  explicit PathBlock(const ViewTracer& tracer, PacketLog* log = nullptr);

  /// Traces `samples` samples of the texels from column `left` and row `top` on; fewer where a
  /// texel reaches TraceSettings::error, measured in `error_scales`, one a light; empty: all of
  /// them. What follows tells of the last call.
  void trace(const Direction& view, std::uint64_t view_key, int samples,
             std::span<const double> error_scales, int left, int top);

  /// Traces `samples` paths that leave each of the cells, at most `texels_for`; a mean is then
  /// what the cell reflects towards its front of light that has been reflected before. The
  /// "texels" of what follows are the cells.
  /// @param first  the number of the first cell, for the random numbers.
  void trace_indirect(std::span<const Cell> cells, std::uint64_t first, int samples);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  /// Of the block's texels (row * columns + column).
  const TexelSums& sums() const { return sums_; }
  /// Share of the texel's rays that hit above `TraceSettings::cut_height`.
  float coverage(std::size_t texel) const {
    return static_cast<float>(covered_[texel]) / static_cast<float>(sums_.samples(texel));
  }
  const TraceStatistics& statistics() const { return statistics_; }

 private:
  struct Path {
    Rgb throughput;
    Vec3 direction;       // of the ray that arrives
    std::uint32_t facet;  // or, after the facets, a segment of a curve
    float u, v;
    std::uint32_t texel;  // of the block
    std::uint32_t sample;
    float hit_weight = 1;  // of what the ray meets: more where only some such rays are traced
  };

  // Where a path has arrived; z of the frame is the shading normal on the viewer's side.
  struct Vertex {
    Vec3 facet_normal;  // on the viewer's side
    Frame frame;
    Direction view;  // in the frame
    const Bsdf* bsdf = nullptr;
    const VisibilityTable::Answer* answers = nullptr;
    const RgbLanes* indirect = nullptr;  // light reflected before; null where it is to be traced
  };

  // A pair of dimensions of one texel's paths in a wave: they come texel by texel.
  struct TexelPoints {
    std::uint32_t texel = none;
    SamplePoints points;
    static constexpr std::uint32_t none = 0xFFFFFFFF;
  };

  // Two numbers of a pair of dimensions, for a path; `drawn` keeps those of its texel.
  std::array<float, 2> stratified(TexelPoints& drawn, const Path& path, std::uint64_t pair) const {
    if (drawn.texel != path.texel) draw(drawn, path.texel, pair);
    return drawn.points[path.sample - first_sample_];
  }
  void draw(TexelPoints& drawn, std::uint32_t texel, std::uint64_t pair) const;
  std::array<float, 2> random(const Path& path, std::uint64_t pair) const;
  // The pair that decides what is checked at a vertex; others of a bounce are before it.
  static constexpr std::uint64_t check_pair(int bounce) {
    return 3 * static_cast<std::uint64_t>(bounce) + 3;
  }
  // Which sums of the wave a path adds to.
  std::uint32_t slot(const Path& path) const {
    return sums_.slot(path.texel, path.sample - first_sample_);
  }
  // Traces texels by paths from the eye, or cells (where there are any) by paths that leave them.
  void trace_waves(std::size_t texels, int samples, std::span<const double> error_scales,
                   std::span<const Cell> cells);
  void start_paths();
  void start_paths_on(std::span<const Cell> cells);
  // Traces the ray that `path` is to follow, packet by packet; keeps the paths that hit.
  void send(const Path& path, const Vec3& origin, Coherence coherence);
  void flush(Coherence coherence);
  // Where paths begin on the surface, they bring indirect light alone.
  void follow_paths(bool from_surface);
  // Asks the table for sixteen paths from `first` on: what they wait for in memory comes at once.
  void look_up(std::size_t first);
  // False for a triangle without an area.
  bool arrive(const Path& path, const VisibilityTable::Answer* answers, Vertex& vertex,
              Vec3& origin) const;
  void arrive_on_curve(const Path& path, Vertex& vertex, Vec3& origin) const;
  // Adds the light that the path's vertex reflects directly, from every light.
  void connect(const Path& path, const Vertex& vertex, const Vec3& origin, int bounce);
  // The same: `reflect` gives what sixteen directions of lights are worth, were they seen.
  template <typename Reflect>
  void connect_all(const Path& path, const Vertex& vertex, const Vec3& origin, int bounce,
                   const Reflect& reflect);
  // Adds the light that the path's vertex reflects and that was reflected before, from the cache.
  void add_indirect(const Path& path, const RgbLanes* indirect);
  void trace_connections(ShadowQueue& queue, Coherence coherence);
  // Draws where a path goes on. False where it ends.
  bool scatter(Path& path, const Vertex& vertex, int bounce);
  // Of what the ray that goes on meets: 0, not to be traced, for most of those of which the table
  // is nearly certain that they meet nothing, and more than 1 for the others of these.
  float weight_of_hit(const Path& path, const Vertex& vertex, int bounce);
  // Keeps the texels that need more samples.
  void drop_settled(std::span<const double> error_scales, bool last);

  HitPacket packet_{};
  TexelPoints places_;      // in the texel
  TexelPoints directions_;  // of the first bounce
  TexelPoints lobes_;       // of the first bounce
  const ViewTracer& tracer_;
  PacketLog* log_;
  std::size_t groups_;  // of sixteen lights
  Direction view_;
  int left_ = 0;
  int top_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> active_;  // texels that get more samples
  std::vector<std::uint32_t> covered_;
  std::uint32_t first_sample_ = 0;   // of the wave
  std::uint32_t samples_ = 0;        // of each texel in the wave
  std::vector<std::uint64_t> keys_;  // of each texel, for its random numbers
  std::vector<Path> paths_;
  std::vector<Path> next_;
  std::array<const VisibilityTable::Answer*, lanes> answers_{};  // to paths, sixteen in a row
  std::array<Path, lanes> sent_;
  std::size_t sent_count_ = 0;
  ShadowQueue first_connections_;
  ShadowQueue later_connections_;  // of paths that were reflected before
  TexelSums sums_;
  TraceStatistics statistics_;
};

}  // namespace weft
