#include "codecs/ring_stencil.h"

#include <fmt/core.h>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "codecs/stencil_glsl.h"
#include "codecs/wide_vector.h"

namespace weft {

namespace {

constexpr float same_angle = 1e-3F;  // radians
constexpr float pi = std::numbers::pi_v<float>;

Wide floor_of(Wide x) {
  for (std::size_t i = 0; i < wide_lanes; ++i) x[i] = std::floor(x[i]);
  return x;
}
Wide root_of(Wide x) {
  for (std::size_t i = 0; i < wide_lanes; ++i) x[i] = std::sqrt(x[i]);
  return x;
}

// column[ring], the ring a whole number.
Wide picked(const std::array<float, RingStencil::most_rings>& column, const Wide& ring) {
#ifdef __AVX512F__
  static_assert(RingStencil::most_rings == 2 * wide_lanes);
#endif
  const WideInt index = __builtin_convertvector(ring, WideInt);
#ifdef __AVX512F__
  return __builtin_shuffle(load<Wide>(column.data()), load<Wide>(column.data() + wide_lanes),
                           index);
#else
  Wide values;
  for (std::size_t i = 0; i < wide_lanes; ++i) values[i] = column[index[i]];
  return values;
#endif
}

Wide absolute(const Wide& x) {
  return x < 0.0F ? -x : x;
}

// asin of a in [0, sqrt(1/2)], and atan of a in [0, 1], to 1e-7 (minimax polynomials in a^2):
// numbers of both alike, so that one direction's are computed side by side.
constexpr std::array<float, 7> arcsine{
    0.166638657F, 0.0758156031F, 0.036256399F, 0.0705220848F, -0.0715999156F, 0.111696109F, 0};
constexpr std::array<float, 7> arctangent{-0.333316594F,  0.199627042F,   -0.139765814F,
                                          0.0979423448F,  -0.0577735864F, 0.0230401345F,
                                          -0.00435540546F};

// Powers in pairs: half the chain of products that wait for each other.
template <typename F>
F arc(const std::array<F, 7>& c, const F& a) {
  const F q = a * a;
  const F q2 = q * q;
  const F p =
      (c[0] + c[1] * q) + q2 * (c[2] + c[3] * q) + q2 * q2 * ((c[4] + c[5] * q) + c[6] * q2);
  return a + a * q * p;
}

Wide arc(const std::array<float, 7>& coefficients, const Wide& a) {
  std::array<Wide, 7> c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = Wide{} + coefficients[i];
  return arc<Wide>(c, a);
}

// The angle from +z of a unit vector: without a division.
Wide polar_angle(const Wide& sine, const Wide& cosine) {
  const Wide angle = arc(arcsine, sine > cosine ? cosine : sine);
  return sine > cosine ? pi / 2 - angle : angle;
}

constexpr float least_divisor = 1e-30F;

// atan2; 0 of (0, 0). Without a square root, and so not of the unit vector. The octant's sign and
// offset are there before its angle is.
Wide azimuth(const Wide& x, const Wide& y) {
  const Wide ax = absolute(x);
  const Wide ay = absolute(y);
  const Wide larger = ay > ax ? ay : ax;
  const Wide eighth = arc(
      arctangent, (ay > ax ? ax : ay) / (larger > least_divisor ? larger : Wide{} + least_divisor));
  Wide sign = ay > ax ? Wide{} - 1.0F : Wide{} + 1.0F;
  Wide offset = ay > ax ? Wide{} + pi / 2 : Wide{};
  sign = x < 0.0F ? -sign : sign;
  offset = x < 0.0F ? pi - offset : offset;
  sign = y < 0.0F ? -sign : sign;
  offset = y < 0.0F ? -offset : offset;
  return offset + sign * eighth;
}

// The same of one direction: theta and phi side by side, and octants from a table, as scalars'
// selects would be branches that no CPU foresees (a query of `lobes` by itself takes 3 % less than
// with the above, in which all lanes are one direction's).
struct SphericalAngles {
  float theta;
  float phi;
};

struct Turned {
  float offset;
  float sign;
};
constexpr std::array<Turned, 2> polar_half{{{0, 1}, {pi / 2, -1}}};
constexpr std::array<Turned, 8> octants{{{0, 1},
                                         {pi / 2, -1},
                                         {pi, -1},
                                         {pi - pi / 2, 1},
                                         {-0.0F, -1},
                                         {-pi / 2, 1},
                                         {-pi, 1},
                                         {-(pi - pi / 2), -1}}};

SphericalAngles spherical_angles(const Direction& d) {
  const float sine = std::sqrt(d.x * d.x + d.y * d.y);
  const float ax = std::abs(d.x);
  const float ay = std::abs(d.y);
  const Turned& polar = polar_half[static_cast<std::size_t>(sine > d.z)];
  const Turned& octant =
      octants[static_cast<std::size_t>(ay > ax) | static_cast<std::size_t>(d.x < 0) << 1 |
              static_cast<std::size_t>(d.y < 0) << 2];
  constexpr auto both = [](std::size_t i) { return Vec4{arcsine[i], arctangent[i], 0, 0}; };
  const std::array<Vec4, 7> c{both(0), both(1), both(2), both(3), both(4), both(5), both(6)};
  const Vec4 angle =
      arc<Vec4>(c, Vec4{std::min(sine, d.z),
                        std::min(ax, ay) / std::max(std::max(ax, ay), least_divisor), 0, 0});
  return {polar.offset + polar.sign * angle[0], octant.offset + octant.sign * angle[1]};
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
  for (std::size_t i = 0; i + 1 < ring_count_; ++i) {
    rings_.per_width[i] = 1 / (rings_.theta[i + 1] - rings_.theta[i]);
    const auto of_two = [i](const Column& column) {
      return std::array<float, 4>{column[i], column[i + 1], 0, 0};
    };
    bands_.push_back({.theta = rings_.theta[i],
                      .per_width = rings_.per_width[i],
                      .steps = of_two(rings_.steps),
                      .zero = of_two(rings_.zero),
                      .first = {static_cast<std::int32_t>(rings_.first[i]),
                                static_cast<std::int32_t>(rings_.first[i + 1]), 0, 0}});
  }
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

RingStencil::Bilinear RingStencil::place(const Wide& x, const Wide& y, const Wide& z) const {
  const Wide theta = polar_angle(root_of(x * x + y * y), z);
  const Wide phi = azimuth(x, y);
  // By the cosine, which is there before theta is; the weight below is held, so that rounding at a
  // ring does no harm.
  Wide band{};
  for (std::size_t ring = 1; ring + 1 < ring_count_; ++ring)
    band += z <= rings_.cosine[ring] ? Wide{} + 1.0F : Wide{};
  Wide lower = (theta - picked(rings_.theta, band)) * picked(rings_.per_width, band);
  lower = lower < 0.0F ? Wide{} : lower;
  lower = lower > 1.0F ? Wide{} + 1.0F : lower;
  Bilinear bilinear;
  for (std::size_t k = 0; k < 2; ++k) {
    const Wide ring = band + static_cast<float>(k);
    const Wide asked = phi * picked(rings_.steps, ring) + picked(rings_.zero, ring);
    const Wide at = asked > 0.0F ? asked : Wide{};  // of a NaN, the first
    const Wide below = floor_of(at);
    const Wide share = asked - below;
    bilinear.pair[k] = picked(rings_.first, ring) + below;
    const Wide ring_weight = k == 0 ? 1.0F - lower : lower;
    bilinear.weight[2 * k] = ring_weight * (1.0F - share);
    bilinear.weight[2 * k + 1] = ring_weight * share;
  }
  return bilinear;
}

StencilBatch RingStencil::locate(const HemisphereSampling& sampling,
                                 const DirectionLanes& directions) const {
  if (!has_rings()) return triangulation_.locate(sampling, directions);
  StencilBatch batch;
  for (std::size_t first = 0; first < batch_lanes; first += wide_lanes) {
    const Bilinear bilinear =
        place(load<Wide>(&directions.x[first]), load<Wide>(&directions.y[first]),
              load<Wide>(&directions.z[first]));
    const WideInt upper = __builtin_convertvector(bilinear.pair[0], WideInt);
    const WideInt lower = __builtin_convertvector(bilinear.pair[1], WideInt);
    for (std::size_t i = 0; i < wide_lanes; ++i) {
      StencilLane& lane = batch[first + i];
      std::memcpy(&lane.index[0], &pairs_[static_cast<std::size_t>(upper[i])], sizeof pairs_[0]);
      std::memcpy(&lane.index[2], &pairs_[static_cast<std::size_t>(lower[i])], sizeof pairs_[0]);
      for (std::size_t k = 0; k < 4; ++k) lane.weight[k] = bilinear.weight[k][i];
    }
  }
  return batch;
}

// By the cosine, as above: after how many of the rings, but for the first and the last.
[[gnu::always_inline]] inline const RingStencil::Band& RingStencil::band_of(float cosine) const {
#ifdef __AVX512F__
  const Wide asked = Wide{} + cosine;
  const std::uint32_t after =
      _mm512_cmp_ps_mask((__m512)asked, (__m512)load<Wide>(rings_.cosine.data()), _CMP_LE_OQ) |
      static_cast<std::uint32_t>(_mm512_cmp_ps_mask(
          (__m512)asked, (__m512)load<Wide>(&rings_.cosine[wide_lanes]), _CMP_LE_OQ))
          << wide_lanes;
  const std::uint32_t between = (1U << (ring_count_ - 1)) - 2;
  return bands_[static_cast<std::size_t>(std::popcount(after & between))];
#else
  std::size_t band = 0;
  for (std::size_t ring = 1; ring + 1 < ring_count_; ++ring)
    band += static_cast<std::size_t>(cosine <= rings_.cosine[ring]);
  return bands_[band];
#endif
}

StencilLane RingStencil::locate(const HemisphereSampling& sampling,
                                const Direction& direction) const {
  if (!has_rings()) {
    const Stencil s = sampling.locate(direction);
    return {{s.index[0], s.index[1], s.index[2], 0}, {s.weight[0], s.weight[1], s.weight[2], 0}};
  }
  const SphericalAngles angles = spherical_angles(direction);
  const Band& band = band_of(direction.z);
  Vec4 lower = Vec4{} + (angles.theta - band.theta) * band.per_width;
  lower = lower < 0.0F ? Vec4{} : lower;
  lower = lower > 1.0F ? Vec4{} + 1.0F : lower;
  // Two rings side by side. What is asked is held at 0 for a NaN: then the first.
  const Vec4 asked = angles.phi * load<Vec4>(band.steps.data()) + load<Vec4>(band.zero.data());
  const Int4 below = __builtin_convertvector(not_negative(asked), Int4);
  const Vec4 share = asked - __builtin_convertvector(below, Vec4);
  Int4 pair;
  std::memcpy(&pair, band.first.data(), sizeof pair);
  pair += below;
  const Vec4 ring_weight = __builtin_shufflevector(1.0F - lower, lower, 0, 4, 1, 5);
  const Vec4 weight =
      __builtin_shufflevector(ring_weight * (1.0F - share), ring_weight * share, 0, 4, 1, 5);
  StencilLane stencil;
  for (std::size_t k = 0; k < 2; ++k) {
    std::memcpy(&stencil.index[2 * k], &pairs_[static_cast<std::size_t>(pair[k])],
                sizeof pairs_[0]);
  }
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
