#include "codecs/ring_stencil.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "codecs/stencil_glsl.h"
#include "codecs/wide_vector.h"

namespace weft {

namespace {

constexpr float same_angle = 1e-3F;  // radians
constexpr float pi = std::numbers::pi_v<float>;

// As many directions side by side as the CPU takes, or one, four times: of floats alone the
// compiler would make branches that no CPU foresees.
#ifdef __AVX512F__
using Wide = Vec16;
#else
using Wide = Vec8;
#endif
constexpr std::size_t wide = sizeof(Wide) / sizeof(float);
using WideInt = std::int32_t __attribute__((vector_size(sizeof(Wide))));

Vec4 floor_of(Vec4 x) {
  for (std::size_t i = 0; i < 4; ++i) x[i] = std::floor(x[i]);
  return x;
}
Wide floor_of(Wide x) {
  for (std::size_t i = 0; i < wide; ++i) x[i] = std::floor(x[i]);
  return x;
}
Vec4 root_of(Vec4 x) {
  for (std::size_t i = 0; i < 4; ++i) x[i] = std::sqrt(x[i]);
  return x;
}
Wide root_of(Wide x) {
  for (std::size_t i = 0; i < wide; ++i) x[i] = std::sqrt(x[i]);
  return x;
}

// column[ring], the ring a whole number.
Vec4 picked(const std::array<float, 32>& column, const Vec4& ring) {
  return Vec4{} + column[static_cast<std::size_t>(static_cast<int>(ring[0]))];
}
Wide picked(const std::array<float, 32>& column, const Wide& ring) {
  const WideInt index = __builtin_convertvector(ring, WideInt);
#ifdef __AVX512F__
  return __builtin_shuffle(load<Wide>(column.data()), load<Wide>(column.data() + wide), index);
#else
  Wide values;
  for (std::size_t i = 0; i < wide; ++i) values[i] = column[index[i]];
  return values;
#endif
}

template <typename F>
F absolute(const F& x) {
  return x < 0.0F ? -x : x;
}

// asin of a in [0, sqrt(1/2)], to 1e-7 (a minimax polynomial, as below).
template <typename F>
F arcsine(const F& a) {
  const F q = a * a;
  const F q2 = q * q;
  const F p = (0.166638657F + 0.0758156031F * q) + q2 * (0.036256399F + 0.0705220848F * q) +
              q2 * q2 * (0.111696109F * q - 0.0715999156F);
  return a + a * q * p;
}

// atan of a in [0, 1], to 1e-7.
template <typename F>
F arctangent(const F& a) {
  const F q = a * a;
  const F q2 = q * q;
  const F p = (0.199627042F * q - 0.333316594F) + q2 * (0.0979423448F * q - 0.139765814F) +
              q2 * q2 * ((0.0230401345F * q - 0.0577735864F) - 0.00435540546F * q2);
  return a + a * q * p;
}

// The angle from +z of a unit vector: without a division.
template <typename F>
F polar_angle(const F& sine, const F& cosine) {
  const F angle = arcsine<F>(sine > cosine ? cosine : sine);
  return sine > cosine ? pi / 2 - angle : angle;
}

// atan2; 0 of (0, 0). Without a square root, and so not of the unit vector. The octant's sign and
// offset are there before its angle is.
template <typename F>
F azimuth(const F& x, const F& y) {
  const F ax = absolute(x);
  const F ay = absolute(y);
  const F larger = ay > ax ? ay : ax;
  const F eighth = arctangent<F>((ay > ax ? ax : ay) / (larger > 1e-30F ? larger : F{} + 1e-30F));
  F sign = ay > ax ? F{} - 1.0F : F{} + 1.0F;
  F offset = ay > ax ? F{} + pi / 2 : F{};
  sign = x < 0.0F ? -sign : sign;
  offset = x < 0.0F ? pi - offset : offset;
  sign = y < 0.0F ? -sign : sign;
  offset = y < 0.0F ? -offset : offset;
  return offset + sign * eighth;
}

struct Placed {
  float theta;
  float phi;
  std::uint16_t index;
};

// Directions of one theta each, phi ascending; theta ascending.
std::vector<std::vector<Placed>> by_theta(const HemisphereSampling& sampling) {
  std::vector<Placed> all;
  for (std::size_t i = 0; i < sampling.size(); ++i)
    all.push_back({theta_of(sampling[i]), phi_of(sampling[i]), static_cast<std::uint16_t>(i)});
  std::ranges::stable_sort(all, {}, &Placed::theta);
  std::vector<std::vector<Placed>> rings;
  for (const Placed& p : all) {
    if (rings.empty() || p.theta - rings.back().front().theta > same_angle) rings.emplace_back();
    rings.back().push_back(p);
  }
  for (auto& ring : rings) std::ranges::stable_sort(ring, {}, &Placed::phi);
  return rings;
}

bool is_evenly_spaced(const std::vector<Placed>& ring) {
  if (ring.size() < 3) return false;
  const float step = 2 * pi / static_cast<float>(ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (std::abs(ring[i].phi - ring[0].phi - static_cast<float>(i) * step) > same_angle)
      return false;
  }
  return true;
}

constexpr const char* ring_glsl = R"(
vec4 $_ring(int ring) { return texelFetch($_rings, ring); }

// Two of a ring's directions around phi, and the share of the second.
void $_around(int ring, float phi, out ivec2 index, out float share) {
  vec4 r = $_ring(ring);
  int count = int(r.z);
  float place = (phi - r.y) * r.z / 6.2831853071795865;
  float below = floor(place);
  share = place - below;
  int low = int(below);
  low = low < 0 ? low + count : low >= count ? low - count : low;
  int high = low + 1 == count ? 0 : low + 1;
  index = ivec2(texelFetch($_order, int(r.w) + low).r, texelFetch($_order, int(r.w) + high).r);
}

btf_QuadStencil $_locate(vec3 direction) {
  float theta = atan(length(direction.xy), direction.z);
  float phi = direction.x == 0.0 && direction.y == 0.0 ? 0.0 : atan(direction.y, direction.x);
  int band = 0;
  for (int i = 1; i + 1 < #RINGS; ++i) {
    if (theta >= $_ring(i).x) band = i;
  }
  float start = $_ring(band).x;
  float lower = clamp((theta - start) / ($_ring(band + 1).x - start), 0.0, 1.0);
  ivec2 a, b;
  float s, t;
  $_around(band, phi, a, s);
  $_around(band + 1, phi, b, t);
  return btf_QuadStencil(ivec4(a, b), vec4((1.0 - lower) * (1.0 - s), (1.0 - lower) * s,
                                           lower * (1.0 - t), lower * t));
}
)";

constexpr const char* triangulation_glsl = R"(
btf_QuadStencil $_locate(vec3 direction) {
  btf_Stencil s = $_triangle_locate(direction);
  return btf_QuadStencil(ivec4(s.index, s.index.x), vec4(s.weight, 0.0));
}
)";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

}  // namespace

RingStencil::RingStencil(const HemisphereSampling& sampling) : triangulation_(sampling) {
  const auto rings = by_theta(sampling);
  const bool has_pole = rings[0].size() == 1 && rings[0][0].theta < same_angle;
  if (!has_pole || rings.size() < 2 || rings.size() > most_rings ||
      sampling.horizon() != Horizon::hold ||
      !std::all_of(rings.begin() + 1, rings.end(), is_evenly_spaced))
    return;
  for (const auto& ring : rings) {
    std::vector<std::uint16_t> directions;
    for (const Placed& p : ring) directions.push_back(p.index);
    append_ring(directions, ring[0].theta, ring[0].phi);
  }
  for (std::size_t i = 0; i + 1 < ring_count_; ++i)
    rings_.per_width[i] = 1 / (rings_.theta[i + 1] - rings_.theta[i]);
}

void RingStencil::append_ring(std::span<const std::uint16_t> directions, float theta,
                              float first_phi) {
  const auto n = static_cast<int>(directions.size());
  const auto count = static_cast<float>(n);
  const std::size_t i = ring_count_++;
  rings_.theta[i] = theta;
  rings_.cosine[i] = std::cos(theta);
  rings_.steps[i] = count / (2 * pi);
  // phi and first_phi are at most one turn apart.
  rings_.zero[i] = count + 1 - first_phi * rings_.steps[i];
  rings_.first[i] = static_cast<float>(pairs_.size());
  for (int k = 0; k < 2 * n + 3; ++k) {
    pairs_.push_back({directions[static_cast<std::size_t>((k + n - 1) % n)],
                      directions[static_cast<std::size_t>((k + n) % n)]});
  }
  glsl_rings_.insert(glsl_rings_.end(),
                     {theta, first_phi, count, static_cast<float>(glsl_order_.size())});
  glsl_order_.insert(glsl_order_.end(), directions.begin(), directions.end());
}

template <typename F>
RingStencil::Bilinear<F> RingStencil::place(const F& x, const F& y, const F& z) const {
  const F theta = polar_angle<F>(root_of(x * x + y * y), z);
  const F phi = azimuth<F>(x, y);
  // By the cosine, which is there before theta is; the weight below is held, so that rounding at a
  // ring does no harm.
  F band{};
  for (std::size_t ring = 1; ring + 1 < ring_count_; ++ring)
    band += z <= rings_.cosine[ring] ? F{} + 1.0F : F{};
  F lower = (theta - picked(rings_.theta, band)) * picked(rings_.per_width, band);
  lower = lower < 0.0F ? F{} : lower;
  lower = lower > 1.0F ? F{} + 1.0F : lower;
  Bilinear<F> bilinear;
  for (std::size_t k = 0; k < 2; ++k) {
    const F ring = band + static_cast<float>(k);
    const F asked = phi * picked(rings_.steps, ring) + picked(rings_.zero, ring);
    const F at = asked > 0.0F ? asked : F{};  // of a NaN, the first
    const F below = floor_of(at);
    const F share = asked - below;
    bilinear.pair[k] = picked(rings_.first, ring) + below;
    const F ring_weight = k == 0 ? 1.0F - lower : lower;
    bilinear.weight[2 * k] = ring_weight * (1.0F - share);
    bilinear.weight[2 * k + 1] = ring_weight * share;
  }
  return bilinear;
}

StencilBatch RingStencil::locate(const HemisphereSampling& sampling,
                                 const DirectionLanes& directions) const {
  if (!has_rings()) return triangulation_.locate(sampling, directions);
  StencilBatch batch;
  for (std::size_t first = 0; first < batch_lanes; first += wide) {
    const Bilinear<Wide> bilinear =
        place(load<Wide>(&directions.x[first]), load<Wide>(&directions.y[first]),
              load<Wide>(&directions.z[first]));
    const WideInt upper = __builtin_convertvector(bilinear.pair[0], WideInt);
    const WideInt lower = __builtin_convertvector(bilinear.pair[1], WideInt);
    for (std::size_t i = 0; i < wide; ++i) {
      StencilLane& lane = batch[first + i];
      std::memcpy(&lane.index[0], &pairs_[static_cast<std::size_t>(upper[i])], sizeof pairs_[0]);
      std::memcpy(&lane.index[2], &pairs_[static_cast<std::size_t>(lower[i])], sizeof pairs_[0]);
      for (std::size_t k = 0; k < 4; ++k) lane.weight[k] = bilinear.weight[k][i];
    }
  }
  return batch;
}

StencilLane RingStencil::locate(const HemisphereSampling& sampling,
                                const Direction& direction) const {
  if (!has_rings()) {
    const Stencil s = sampling.locate(direction);
    return {{s.index[0], s.index[1], s.index[2], 0}, {s.weight[0], s.weight[1], s.weight[2], 0}};
  }
  const Bilinear<Vec4> bilinear =
      place(Vec4{} + direction.x, Vec4{} + direction.y, Vec4{} + direction.z);
  const auto pair = [&](std::size_t k) {
    return &pairs_[static_cast<std::size_t>(static_cast<int>(bilinear.pair[k][0]))];
  };
  const auto& w = bilinear.weight;
  const Vec4 weight{w[0][0], w[1][0], w[2][0], w[3][0]};
  StencilLane stencil;
  std::memcpy(&stencil.index[0], pair(0), sizeof pairs_[0]);
  std::memcpy(&stencil.index[2], pair(1), sizeof pairs_[0]);
  std::memcpy(stencil.weight.data(), &weight, sizeof weight);
  return stencil;
}

GlProgram RingStencil::glsl(const HemisphereSampling& sampling, const std::string& prefix) const {
  GlProgram program;
  std::string text = "struct btf_QuadStencil { ivec4 index; vec4 weight; };\n";
  if (!has_rings()) {
    program = hemisphere_sampling_glsl(sampling, prefix + "_triangle");
    text = program.glsl + text + triangulation_glsl;
  } else {
    program.textures.push_back(
        buffer_texture(prefix + "_rings", GlTexture::Format::rgba32f, glsl_rings_));
    program.textures.push_back(
        buffer_texture(prefix + "_order", GlTexture::Format::r16ui, glsl_order_));
    text += ring_glsl;
  }
  program.glsl = replaced(replaced(text, "$", prefix), "#RINGS", std::to_string(ring_count_));
  return program;
}

}  // namespace weft
