// How the paths of a block are connected to the lights.
#include <bit>

#include "acquisition/path_block.h"
#include "btf/random.h"

namespace weft {

namespace {

// One certain answer in so many is checked.
constexpr std::uint32_t check_every = 256;

}  // namespace

void PathBlock::connect(const Path& path, const Vertex& vertex, const Vec3& origin, int bounce) {
  const Bsdf::ViewTerms terms = vertex.bsdf->view_terms(vertex.view);
  const Frame& frame = vertex.frame;
  if (vertex.bsdf->kind() == Bsdf::Kind::lambert) {
    const Vec3Lanes upright{{}, {}, all_lanes(1)};
    const RgbLanes a_cosine = vertex.bsdf->evaluate(upright, terms) * path.throughput;
    connect_all(path, vertex, origin, bounce, [&](const Vec3Lanes& lights) {
      const FloatLanes cosine = larger(dot(frame.z, lights), 0);
      return RgbLanes{a_cosine.r * cosine, a_cosine.g * cosine, a_cosine.b * cosine};
    });
  } else {
    connect_all(path, vertex, origin, bounce, [&](const Vec3Lanes& lights) {
      return vertex.bsdf->evaluate(
                 {dot(frame.x, lights), dot(frame.y, lights), dot(frame.z, lights)}, terms) *
             path.throughput;
    });
  }
}

template <typename Reflect>
void PathBlock::connect_all(const Path& path, const Vertex& vertex, const Vec3& origin, int bounce,
                            const Reflect& reflect) {
  const LightSet& lights = tracer_.lights();
  const std::uint32_t checked =
      static_cast<std::uint32_t>(
          hash_coordinates(keys_[path.texel], check_pair(bounce), path.sample) >> 32) %
      check_every;
  ShadowQueue& queue = bounce == 0 ? first_connections_ : later_connections_;
  const std::uint32_t slot = this->slot(path);
  FloatLanes* wave = sums_.wave(slot, 0);
  std::int64_t queries = 0;
  for (std::size_t g = 0; g < groups_; ++g, wave += 3) {
    const Vec3Lanes& group = lights.group(g);
    const RgbLanes value = reflect(group);
    const std::uint16_t facing = bits_of_lanes(dot(vertex.facet_normal, group) > 0);
    const auto [known, visible] = vertex.answers[g];
    const IntLanes arrives = lanes_of_bits(visible & facing);
    const FloatLanes zero{};
    wave[0] += select(arrives, value.r, zero);
    wave[1] += select(arrives, value.g, zero);
    wave[2] += select(arrives, value.b, zero);
    // A value that is not a number goes on, to be refused where the view is stored.
    const auto asked = static_cast<std::uint16_t>(lights.used_lanes(g) & facing &
                                                  ~bits_of_lanes(value.r + value.g + value.b <= 0));
    queries += std::popcount(unsigned{asked});
    const auto add = [&](int i, ShadowQueue::Answer answer) {
      queue.add(g * lanes + static_cast<std::size_t>(i),
                {origin, slot, answer, value.r[i], value.g[i], value.b[i]});
    };
    for (unsigned left = asked & ~known; left != 0; left &= left - 1)
      add(std::countr_zero(left), ShadowQueue::Answer::unknown);
    // Light l is checked where l % 256 is the number drawn: each with a chance of 1 / 256.
    const std::size_t i = checked - g * lanes % check_every;
    if (i < lanes && ((asked & known) >> i & 1) != 0) {
      add(static_cast<int>(i),
          (visible >> i & 1) != 0 ? ShadowQueue::Answer::visible : ShadowQueue::Answer::hidden);
    }
  }
  statistics_.visibility_queries += queries;
}

void PathBlock::add_indirect(const Path& path, const RgbLanes* indirect) {
  FloatLanes* wave = sums_.wave(slot(path), 0);
  for (std::size_t g = 0; g < groups_; ++g, wave += 3) {
    wave[0] += indirect[g].r * path.throughput.x;
    wave[1] += indirect[g].g * path.throughput.y;
    wave[2] += indirect[g].b * path.throughput.z;
  }
}

void PathBlock::trace_connections(ShadowQueue& queue, Coherence coherence) {
  const auto add = [&](std::size_t light, const ShadowQueue::Connection& c, float weight) {
    FloatLanes* wave = sums_.wave(c.slot, light / lanes);
    wave[0][light % lanes] += weight * c.r;
    wave[1][light % lanes] += weight * c.g;
    wave[2][light % lanes] += weight * c.b;
  };
  const auto arrive = [&](std::size_t light, const ShadowQueue::Connection& c, bool visible) {
    ++statistics_.shadow_rays;
    if (c.answer == ShadowQueue::Answer::unknown) {
      if (visible) add(light, c, 1);
      return;
    }
    ++statistics_.answers_checked;
    if (visible == (c.answer == ShadowQueue::Answer::visible)) return;
    ++statistics_.wrong_answers;
    add(light, c, visible ? check_every : -static_cast<float>(check_every));
  };
  statistics_.rays_traced_on +=
      queue.trace(tracer_.scene(), tracer_.lights().directions(), coherence, log_, arrive);
}

}  // namespace weft
