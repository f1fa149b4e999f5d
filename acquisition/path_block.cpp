#include "acquisition/path_block.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "btf/random.h"

namespace weft {

namespace {

// Connections of later vertices wait for those of further bounces, so that packets are full; where
// there are more than these (8 MB), as the table knows little and paths are long, they are traced
// before the next bounce adds its own.
constexpr std::size_t most_waiting = std::size_t{1} << 18;
constexpr std::uint32_t samples_a_check = 16;   // of each texel in a wave, where it may be the last
constexpr std::uint64_t cell_key = 0x43454C4C;  // stands for a view where paths begin on cells
// Pairs of random numbers of a path: where in the texel, then three a bounce.
constexpr std::uint64_t texel_pair = 0;
constexpr std::uint64_t direction_pair(int bounce) {
  return 3 * static_cast<std::uint64_t>(bounce) + 1;
}
constexpr std::uint64_t lobe_pair(int bounce) {
  return 3 * static_cast<std::uint64_t>(bounce) + 2;
}

}  // namespace

int PathBlock::edge_for(std::size_t lights) {
  if (lights <= 192) return 8;
  return lights <= 768 ? 4 : 2;
}

std::size_t PathBlock::texels_for(std::size_t lights) {
  const auto edge = static_cast<std::size_t>(edge_for(lights));
  return edge * edge;
}

std::size_t PathBlock::bytes_for(std::size_t lights) {
  return TexelSums::bytes_for(texels_for(lights), lights);
}

PathBlock::PathBlock(const ViewTracer& tracer, PacketLog* log)
    : tracer_(tracer),
      log_(log),
      groups_(tracer.lights().groups()),
      first_connections_(tracer.lights().size()),
      later_connections_(tracer.lights().size()),
      sums_(texels_for(tracer.lights().size()), tracer.lights().size()) {
  keys_.resize(texels_for(tracer.lights().size()));
}

void PathBlock::trace(const Direction& view, std::uint64_t view_key, int samples,
                      std::span<const double> error_scales, int left, int top) {
  const TraceSettings& s = tracer_.settings();
  const int edge = edge_for(tracer_.lights().size());
  view_ = view;
  left_ = left;
  top_ = top;
  columns_ = std::min(edge, s.width - left);
  rows_ = std::min(edge, s.height - top);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      const auto texel = static_cast<std::uint64_t>(top + y) * static_cast<std::uint64_t>(s.width) +
                         static_cast<std::uint64_t>(left + x);
      keys_[static_cast<std::size_t>(y) * columns_ + x] = hash_coordinates(s.seed, view_key, texel);
    }
  }
  trace_waves(static_cast<std::size_t>(columns_) * rows_, samples, error_scales, {});
}

void PathBlock::trace_indirect(std::span<const Cell> cells, std::uint64_t first, int samples) {
  columns_ = static_cast<int>(cells.size());
  rows_ = 1;
  for (std::size_t i = 0; i < cells.size(); ++i)
    keys_[i] = hash_coordinates(tracer_.settings().seed, cell_key, first + i);
  trace_waves(cells.size(), samples, {}, cells);
}

void PathBlock::trace_waves(std::size_t texels, int samples, std::span<const double> error_scales,
                            std::span<const Cell> cells) {
  const auto spp = static_cast<std::uint32_t>(samples);
  const bool adaptive = !error_scales.empty();
  const bool from_surface = !cells.empty();
  const std::uint32_t most = adaptive ? samples_a_check : SamplePoints::most;
  sums_.clear(texels, std::clamp(spp, TexelSums::most_groups, most) / TexelSums::most_groups);
  statistics_ = {};
  statistics_.texels = static_cast<std::int64_t>(texels);
  active_.resize(texels);
  std::iota(active_.begin(), active_.end(), 0U);
  covered_.assign(texels, 0);
  for (first_sample_ = 0; first_sample_ < spp && !active_.empty();
       first_sample_ += sums_.wave_size()) {
    samples_ = std::min(sums_.wave_size(), spp - first_sample_);
    for (TexelPoints* points : {&places_, &directions_, &lobes_}) points->texel = TexelPoints::none;
    if (from_surface) {
      start_paths_on(cells);
    } else {
      start_paths();
    }
    follow_paths(from_surface);
    sums_.fold(active_, samples_);
    if (adaptive) drop_settled(error_scales, first_sample_ + samples_ == spp);
  }
}

void PathBlock::draw(TexelPoints& drawn, std::uint32_t texel, std::uint64_t pair) const {
  drawn.texel = texel;
  drawn.points.draw(hash_coordinates(keys_[texel], pair), first_sample_, samples_);
}

std::array<float, 2> PathBlock::random(const Path& path, std::uint64_t pair) const {
  const std::uint64_t bits = hash_coordinates(keys_[path.texel], pair, path.sample);
  return {unit_float(bits), unit_float(bits << 32)};
}

void PathBlock::start_paths() {
  const TraceSettings& s = tracer_.settings();
  const PeriodicScene& scene = tracer_.scene();
  paths_.clear();
  next_.clear();
  const float start = scene.top() + 1e-3F * std::max(1.0F, std::abs(scene.top()));
  const float back = (start - tracer_.mesostructure().reference_height) / view_.z;
  for (const std::uint32_t texel : active_) {
    const int x = left_ + static_cast<int>(texel) % columns_;
    const int y = top_ + static_cast<int>(texel) / columns_;
    draw(places_, texel, texel_pair);
    for (const std::uint32_t i : places_.points.along_curve()) {
      const Path path{Rgb(1, 1, 1), -view_, 0, 0, 0, texel, first_sample_ + i};
      const auto [u, v] = places_.points[i];
      const float px = (static_cast<float>(x) + u) / static_cast<float>(s.width);
      const float py = 1 - (static_cast<float>(y) + v) / static_cast<float>(s.height);
      send(path,
           Vec3(tile_fraction(px + view_.x * back), tile_fraction(py + view_.y * back), start),
           Coherence::coherent);
    }
  }
  flush(Coherence::coherent);
  const std::int64_t started = static_cast<std::int64_t>(active_.size()) * samples_;
  statistics_.paths += started;
  statistics_.primary_rays += started;
  statistics_.missed += started - static_cast<std::int64_t>(next_.size());
}

void PathBlock::start_paths_on(std::span<const Cell> cells) {
  paths_.clear();
  next_.clear();
  for (const std::uint32_t c : active_) {
    const Facet& facet = tracer_.facets()[cells[c].facet];
    if (facet.degenerate()) continue;
    for (std::uint32_t i = 0; i < samples_; ++i) {
      Path path{Rgb(1, 1, 1), -facet.normal, cells[c].facet, 0, 0, c, first_sample_ + i};
      const auto [x, y] = stratified(places_, path, texel_pair);
      // Even over the triangle, as the square is folded along its diagonal.
      const Barycentric at =
          x + y > 1 ? point_of(cells[c], 1 - x, 1 - y) : point_of(cells[c], x, y);
      path.u = at[0];
      path.v = at[1];
      next_.push_back(path);
    }
  }
}

void PathBlock::send(const Path& path, const Vec3& origin, Coherence coherence) {
  sent_[sent_count_] = path;
  packet_.ray.set(sent_count_, origin, path.direction);
  if (++sent_count_ == lanes) flush(coherence);
}

void PathBlock::flush(Coherence coherence) {
  if (sent_count_ == 0) return;
  const auto active = static_cast<std::uint16_t>((1U << sent_count_) - 1U);
  if (log_ != nullptr) log_->add(packet_, active, coherence);
  statistics_.rays_traced_on += tracer_.scene().intersect(packet_, active, coherence);
  for (std::size_t i = 0; i < sent_count_; ++i) {
    if (packet_.mesh[i] == RayHit::none) continue;
    Path& path = next_.emplace_back(sent_[i]);
    path.facet = packet_.primitive[i];
    path.u = packet_.u[i];
    path.v = packet_.v[i];
    if (path.hit_weight > 1) {
      ++statistics_.open_wrong;
      path.throughput *= std::exchange(path.hit_weight, 1.0F);
    }
  }
  sent_count_ = 0;
}

void PathBlock::follow_paths(bool from_surface) {
  const int most = std::min(tracer_.settings().max_bounces, PathEnd::most_bounces);
  const std::optional<float> cut = tracer_.settings().cut_height;
  for (int bounce = 0; !next_.empty(); ++bounce) {
    std::swap(paths_, next_);
    next_.clear();
    const bool last = bounce >= most;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (i % lanes == 0) look_up(i);
      Path& path = paths_[i];
      Vertex vertex;
      Vec3 origin;
      if (!arrive(path, answers_[i % lanes], vertex, origin)) {
        ++statistics_.degenerate;
        continue;
      }
      if (bounce == 0 && cut && origin.z >= *cut) ++covered_[path.texel];
      if (bounce > 0 || !from_surface) connect(path, vertex, origin, bounce);
      if (vertex.indirect != nullptr) {
        add_indirect(path, vertex.indirect);
        continue;
      }
      if (last || !scatter(path, vertex, bounce)) continue;
      path.hit_weight = weight_of_hit(path, vertex, bounce);
      if (path.hit_weight == 0) continue;
      ++statistics_.bounce_rays;
      send(path, origin, Coherence::incoherent);
    }
    flush(Coherence::incoherent);
    if (bounce == 0) trace_connections(first_connections_, Coherence::coherent);
    if (later_connections_.size() > most_waiting)
      trace_connections(later_connections_, Coherence::incoherent);
    if (last && tracer_.settings().max_bounces == TraceSettings::unlimited)
      statistics_.trapped += static_cast<std::int64_t>(paths_.size());
  }
  trace_connections(later_connections_, Coherence::incoherent);
}

void PathBlock::look_up(std::size_t first) {
  const std::size_t count = std::min<std::size_t>(lanes, paths_.size() - first);
  const std::size_t facets = tracer_.facets().size();
  for (std::size_t i = 0; i < count; ++i) {
    if (paths_[first + i].facet < facets)
      __builtin_prefetch(&tracer_.facets()[paths_[first + i].facet]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Path& path = paths_[first + i];
    answers_[i] = tracer_.visibility().at(path.facet, path.u, path.v);
    __builtin_prefetch(answers_[i]);
    __builtin_prefetch(answers_[i] + groups_ - 1);
  }
}

bool PathBlock::arrive(const Path& path, const VisibilityTable::Answer* answers, Vertex& vertex,
                       Vec3& origin) const {
  if (path.facet >= tracer_.facets().size()) {
    arrive_on_curve(path, vertex, origin);
    return true;
  }
  const Facet& facet = tracer_.facets()[path.facet];
  if (facet.degenerate()) return false;
  const bool behind = (facet.normal ^ path.direction) > 0;
  vertex.facet_normal = behind ? -facet.normal : facet.normal;
  vertex.frame = frame_around(shading_normal(tracer_.mesostructure().mesh, path.facet, path.u,
                                             path.v, vertex.facet_normal, behind, path.direction));
  vertex.view = vertex.frame.to_local(-path.direction);
  vertex.bsdf = &tracer_.mesostructure().materials[facet.material];
  const IndirectCache& cache = tracer_.indirect_cache();
  vertex.indirect = cache.empty() || behind ? nullptr : cache.at(path.facet, path.u, path.v);
  vertex.answers = behind ? tracer_.visibility().unknown() : answers;
  origin = ray_origin(facet.point(path.u, path.v), vertex.facet_normal);
  return true;
}

// The table knows nothing of curves.
void PathBlock::arrive_on_curve(const Path& path, Vertex& vertex, Vec3& origin) const {
  const CurveSet& curves = tracer_.mesostructure().curves;
  const std::size_t segment = path.facet - tracer_.facets().size();
  const CurvePoint point = curve_point(curves, segment, path.u, path.v);
  const bool behind = (point.normal ^ path.direction) > 0;
  vertex.facet_normal = behind ? -point.normal : point.normal;
  vertex.frame = frame_around(vertex.facet_normal);
  vertex.view = vertex.frame.to_local(-path.direction);
  vertex.bsdf = &tracer_.mesostructure().materials[curves.materials[segment]];
  vertex.answers = tracer_.visibility().unknown();
  origin = ray_origin(point.position, vertex.facet_normal);
}

bool PathBlock::scatter(Path& path, const Vertex& vertex, int bounce) {
  const auto [u, v] = bounce == 0 ? stratified(directions_, path, direction_pair(bounce))
                                  : random(path, direction_pair(bounce));
  const bool lambert = vertex.bsdf->kind() == Bsdf::Kind::lambert;
  const bool dim = max_component(path.throughput) < PathEnd::dim;
  std::array<float, 2> others{0, 0};  // lobe, roulette
  if (!lambert || dim) {
    others =
        bounce == 0 ? stratified(lobes_, path, lobe_pair(bounce)) : random(path, lobe_pair(bounce));
  }
  const Bsdf::Sample sample = vertex.bsdf->sample(vertex.view, {others[0], u, v});
  if (std::isnan(sample.pdf)) ++statistics_.invalid;
  if (!(sample.pdf > 0)) return false;
  path.direction = vertex.frame.to_world(sample.light).normalized();
  if (!((path.direction ^ vertex.facet_normal) > 0)) return false;
  if (dim) {
    const float brightness = max_component(path.throughput);
    if (!(others[1] * PathEnd::dim < brightness)) return false;
    path.throughput *= PathEnd::dim / brightness;
  }
  path.throughput *= sample.weight;
  return max_component(path.throughput) > 0;
}

float PathBlock::weight_of_hit(const Path& path, const Vertex& vertex, int bounce) {
  if (!tracer_.visibility().is_open(vertex.answers, path.direction)) return 1;
  ++statistics_.open_bounces;
  const std::uint64_t bits = hash_coordinates(keys_[path.texel], check_pair(bounce), path.sample);
  const std::uint32_t every = tracer_.visibility().open_check_every();
  if (static_cast<std::uint32_t>(bits) % every != 0) return 0;
  ++statistics_.open_checked;
  return static_cast<float>(every);
}

void PathBlock::drop_settled(std::span<const double> error_scales, bool last) {
  const double target = tracer_.settings().error;
  const auto squares = static_cast<double>(error_scales.size());
  std::erase_if(active_, [&](std::uint32_t texel) {
    double sum = 0;
    for (std::size_t l = 0; l < error_scales.size(); ++l)
      sum += sums_.grey_variance(texel, l) / (error_scales[l] * error_scales[l]);
    return sum < target * target * squares;
  });
  if (last) statistics_.unsettled += static_cast<std::int64_t>(active_.size());
}

}  // namespace weft
