// The GGX distribution of microfacet normals, isotropic, with height-correlated Smith masking.
//
// Walter et al. 2007 (distribution), Heitz 2014 (correlated masking, eq. 99), Heitz 2018 (visible
// normals). `alpha` is the width itself. Directions are unit vectors with z > 0 in the surface's
// frame.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "btf/direction.h"
#include "tracer/lanes.h"

namespace weft::ggx {

/// Density of normals per sr; `Vector` is one or sixteen. sin^2 is taken from x and y, which keep
/// their digits for a mirror-like alpha.
template <typename Vector>
inline auto density(const Vector& normal, float alpha) {
  const float a2 = alpha * alpha;
  const auto sine2 = normal.x * normal.x + normal.y * normal.y;
  const auto t = sine2 + a2 * normal.z * normal.z;
  return select(t > 0, a2 / (std::numbers::pi_v<float> * t * t), t * 0);
}

/// Smith's Lambda of the distribution (Heitz 2014, eq. 72), in a form that keeps its digits where
/// it is small, as for a mirror-like alpha.
inline float lambda(const Direction& d, float alpha) {
  const float a2s2 = alpha * alpha * (d.x * d.x + d.y * d.y);
  return 0.5F * a2s2 / (d.z * (d.z + std::sqrt(d.z * d.z + a2s2)));
}

/// Share of facets that `d` sees.
inline float masking(const Direction& d, float alpha) {
  return 1 / (1 + lambda(d, alpha));
}

/// `density` of the half vector / ((1 + lambda(light) + lambda(view)) 4 view.z), with few roots and
/// divisions, as these are most of what lanes cost: what a mirror's facets send from `light` to
/// `view`, times light.z. Only where both z > 0; of other lanes it is anything.
/// @param sum          light + view: the half vector times its length.
/// @param view_lambda  `lambda` of the view.
template <typename Vector>
inline auto reflection(const Vector& light, const Vector& sum, const Direction& view,
                       float view_lambda, float alpha) {
  const float a2 = alpha * alpha;
  const auto tangent2 = sum.x * sum.x + sum.y * sum.y;
  const auto normal2 = sum.z * sum.z;
  const auto length2 = tangent2 + normal2;
  const auto t = tangent2 + a2 * normal2;
  // (1 + lambda(light) + lambda(view)) * light.z
  const auto seen =
      (0.5F + view_lambda) * light.z +
      0.5F * square_root(light.z * light.z + a2 * (light.x * light.x + light.y * light.y));
  // At most 1 / a2, and the other at most 2, however small either z is.
  const auto peak = length2 / t;
  const auto share = light.z / seen;
  const float scale = a2 / (4 * std::numbers::pi_v<float> * view.z);
  return select(t > 0, scale * (peak * peak) * share, t * 0);
}

/// A normal with the density of those that `view` sees; u, v in [0, 1).
inline Vec3 sample_visible_normal(const Direction& view, float alpha, float u, float v) {
  const Vec3 stretched = Vec3(alpha * view.x, alpha * view.y, view.z).normalized();
  const float length2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3 t1 =
      length2 > 0 ? Vec3(-stretched.y, stretched.x, 0) / std::sqrt(length2) : Vec3(1, 0, 0);
  const Vec3 t2 = stretched % t1;
  const float r = std::sqrt(u);
  const float phi = 2 * std::numbers::pi_v<float> * v;
  const float p1 = r * std::cos(phi);
  const float s = 0.5F * (1 + stretched.z);
  const float p2 = (1 - s) * std::sqrt(std::max(0.0F, 1 - p1 * p1)) + s * r * std::sin(phi);
  const Vec3 n = t1 * p1 + t2 * p2 + stretched * std::sqrt(std::max(0.0F, 1 - p1 * p1 - p2 * p2));
  return Vec3(alpha * n.x, alpha * n.y, std::max(1e-6F, n.z)).normalized();
}

}  // namespace weft::ggx
