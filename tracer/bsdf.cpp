#include "tracer/bsdf.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tracer/frame.h"
#include "tracer/ggx.h"
#include "tracer/sobol.h"

namespace weft {

namespace {

constexpr float inverse_pi = std::numbers::inv_pi_v<float>;
constexpr int table_size = 4 * lanes;
constexpr int table_samples = 2048;
constexpr int fresnel_samples = 256;
constexpr float least_loss = 1e-12F;  // where nothing is lost, for a quotient of nothing

// `Number`: a float, or sixteen side by side.
template <typename Number>
Number fresnel_dielectric(const Number& cosine, float ior) {
  const Number sine2 = (1 - cosine * cosine) * (1 / (ior * ior));
  const Number t = square_root(larger(1 - sine2, 0.0F));  // 0, all reflected, where sine2 >= 1
  // (s^2 + p^2) / 2, s and p the amplitudes of both polarisations, over one denominator.
  const Number s_over = cosine - ior * t, s_under = cosine + ior * t;
  const Number p_over = t - ior * cosine, p_under = t + ior * cosine;
  const Number over = s_over * p_under, other = p_over * s_under, under = s_under * p_under;
  return select(t > 0, 0.5F * (over * over + other * other) / (under * under), t + 1);
}

// Exact, unpolarised, from vacuum onto eta + i k.
template <typename Number>
Number fresnel_conductor(const Number& cosine, float eta, float k) {
  const Number c2 = cosine * cosine;
  const Number s2 = 1 - c2;
  const Number t0 = eta * eta - k * k - s2;
  const Number a2b2 = square_root(t0 * t0 + 4 * eta * eta * k * k);
  const Number t1 = a2b2 + c2;
  const Number a = square_root(larger(0.5F * (a2b2 + t0), 0.0F));
  const Number t2 = 2 * cosine * a;
  const Number t3 = c2 * a2b2 + s2 * s2;
  const Number t4 = t2 * s2;
  // (s + p) / 2 with s = (t1 - t2) / (t1 + t2) and p = s (t3 - t4) / (t3 + t4), over one
  // denominator.
  return (t1 - t2) * t3 / ((t1 + t2) * (t3 + t4));
}

template <typename Number>
Number schlick(const Number& cosine, float f0) {
  const Number m = 1 - cosine;
  return f0 + (1 - f0) * (m * m * m * m * m);
}

}  // namespace

// What the specular lobe keeps back of light from a direction: 1 - its directional albedo, summed
// up as such, since what a mirror keeps back would drown in the roundings of the difference. Nodes
// are even in the square root of the cosine: it bends most at grazing angles.
struct Bsdf::LossTable {
  std::array<float, table_size> loss{};
  float average = 0;  // over directions, weighted by the cosine

  float at(float cosine) const {
    const float position = std::sqrt(std::clamp(cosine, 0.0F, 1.0F)) * (table_size - 1);
    const int i = std::min(static_cast<int>(position), table_size - 2);
    const float t = position - static_cast<float>(i);
    return loss[i] * (1 - t) + loss[i + 1] * t;
  }
  FloatLanes at(const FloatLanes& cosine) const {
    const FloatLanes position = square_root(smaller(larger(cosine, 0.0F), 1.0F)) * (table_size - 1);
    const IntLanes i =
        __builtin_convertvector(smaller(position, table_size - 2), IntLanes);  // cuts off
    const FloatLanes t = position - __builtin_convertvector(i, FloatLanes);
    return look_up(loss, i) * (1 - t) + look_up(loss, i + 1) * t;
  }

  /// @param fresnel  reflectance of a facet at a cosine.
  template <typename Fresnel>
  LossTable(float alpha, const Fresnel& fresnel) {
    for (int i = 0; i < table_size; ++i) {
      const float root = std::max(static_cast<float>(i) / (table_size - 1), 1e-3F);
      const float cosine = root * root;
      const Direction view(std::sqrt(std::max(0.0F, 1 - cosine * cosine)), 0, cosine);
      const float view_lambda = ggx::lambda(view, alpha);
      double sum = 0;
      for (std::uint32_t s = 0; s < table_samples; ++s) {
        const auto [u, v] = sobol_point(s, 0);
        const Vec3 half_vector = ggx::sample_visible_normal(view, alpha, u, v);
        const float across = view ^ half_vector;
        const Direction light = half_vector * (2 * across) - view;
        if (light.z <= 0 || across <= 0) {
          sum += 1;
          continue;
        }
        // 1 - f (1 + lambda(view)) / (1 + lambda(light) + lambda(view))
        const float hidden = ggx::lambda(light, alpha);
        const float f = fresnel(across);
        sum += 1 - f + f * hidden / (1 + hidden + view_lambda);
      }
      loss[i] = static_cast<float>(sum / table_samples);
    }
    // 2 * integral of loss(c) c dc = 4 * integral of loss(r) r^3 dr, r the root of c: exact, as the
    // loss is linear in r between nodes.
    double sum = 0;
    for (int i = 0; i + 1 < table_size; ++i) {
      const double a = static_cast<double>(i) / (table_size - 1);
      const double b = static_cast<double>(i + 1) / (table_size - 1);
      const double slope = (static_cast<double>(loss[i + 1]) - loss[i]) / (b - a);
      sum += (loss[i] - slope * a) * (std::pow(b, 4) - std::pow(a, 4)) +
             slope * 0.8 * (std::pow(b, 5) - std::pow(a, 5));
    }
    average = static_cast<float>(sum);
  }
};

Bsdf Bsdf::lambert(const Rgb& albedo) {
  Bsdf bsdf;
  bsdf.albedo_ = albedo;
  return bsdf;
}

namespace {

// Part of the light that leaves after more than one reflection between facets, by colour: Kulla and
// Conty, "Revisiting physically based shading at Imageworks", 2017.
Rgb multiple_reflections(const std::function<Rgb(float)>& fresnel, float average_loss) {
  Imath::V3d average(0, 0, 0);
  for (int i = 0; i < fresnel_samples; ++i) {
    const float cosine = (static_cast<float>(i) + 0.5F) / fresnel_samples;
    const Rgb f = fresnel(cosine);
    average += Imath::V3d(f.x, f.y, f.z) * (2.0 * cosine / fresnel_samples);
  }
  const auto term = [&](double f) {
    return static_cast<float>(f * f * (1 - average_loss) / (1 - f * average_loss));
  };
  return {term(average.x), term(average.y), term(average.z)};
}

}  // namespace

Bsdf Bsdf::conductor(const Rgb& eta, const Rgb& k, float alpha) {
  Bsdf bsdf;
  bsdf.kind_ = Kind::conductor;
  bsdf.eta_ = eta;
  bsdf.k_ = k;
  bsdf.alpha_ = alpha;
  bsdf.loss_ = std::make_shared<const LossTable>(alpha, [](float) { return 1.0F; });
  bsdf.multiple_scattering_ =
      multiple_reflections([&](float c) { return bsdf.fresnel(c); }, bsdf.loss_->average);
  return bsdf;
}

Bsdf Bsdf::conductor_f0(const Rgb& f0, float alpha) {
  Bsdf bsdf;
  bsdf.kind_ = Kind::conductor;
  bsdf.f0_ = f0;
  bsdf.schlick_ = true;
  bsdf.alpha_ = alpha;
  bsdf.loss_ = std::make_shared<const LossTable>(alpha, [](float) { return 1.0F; });
  bsdf.multiple_scattering_ =
      multiple_reflections([&](float c) { return bsdf.fresnel(c); }, bsdf.loss_->average);
  return bsdf;
}

Bsdf Bsdf::plastic(const Rgb& albedo, float ior, float alpha) {
  Bsdf bsdf;
  bsdf.kind_ = Kind::plastic;
  bsdf.albedo_ = albedo;
  bsdf.ior_ = ior;
  bsdf.alpha_ = alpha;
  bsdf.loss_ = std::make_shared<const LossTable>(
      alpha, [ior](float c) { return fresnel_dielectric(c, ior); });
  return bsdf;
}

Rgb Bsdf::fresnel(float cosine) const {
  if (kind_ == Kind::plastic) return Rgb(fresnel_dielectric(cosine, ior_));
  if (schlick_) return {schlick(cosine, f0_.x), schlick(cosine, f0_.y), schlick(cosine, f0_.z)};
  return {fresnel_conductor(cosine, eta_.x, k_.x), fresnel_conductor(cosine, eta_.y, k_.y),
          fresnel_conductor(cosine, eta_.z, k_.z)};
}

RgbLanes Bsdf::fresnel(const FloatLanes& cosine) const {
  if (kind_ == Kind::plastic) {
    const FloatLanes f = fresnel_dielectric(cosine, ior_);
    return {f, f, f};
  }
  if (schlick_) return {schlick(cosine, f0_.x), schlick(cosine, f0_.y), schlick(cosine, f0_.z)};
  return {fresnel_conductor(cosine, eta_.x, k_.x), fresnel_conductor(cosine, eta_.y, k_.y),
          fresnel_conductor(cosine, eta_.z, k_.z)};
}

Rgb Bsdf::evaluate(const Direction& light, const Direction& view) const {
  if (!(light.z > 0) || !(view.z > 0)) return {0, 0, 0};
  if (kind_ == Kind::lambert) return albedo_ * (inverse_pi * light.z);
  const Vec3 sum = light + view;
  const float specular = ggx::reflection(light, sum, view, ggx::lambda(view, alpha_), alpha_);
  const Rgb single = fresnel(std::min(1.0F, 0.5F * sum.length())) * specular;
  // What the specular lobe keeps back in either direction; the average is 0 only where nothing is
  // lost.
  const float lost = loss_->at(light.z) * loss_->at(view.z) * inverse_pi * light.z /
                     std::max(loss_->average, least_loss);
  return single + (kind_ == Kind::conductor ? multiple_scattering_ : albedo_) * lost;
}

Bsdf::ViewTerms Bsdf::view_terms(const Direction& view) const {
  ViewTerms terms{.view = view, .lambda = 0, .lost = Rgb(0, 0, 0)};
  if (kind_ == Kind::lambert || !(view.z > 0)) return terms;
  terms.lambda = ggx::lambda(view, alpha_);
  terms.lost = (kind_ == Kind::conductor ? multiple_scattering_ : albedo_) *
               (loss_->at(view.z) * inverse_pi / std::max(loss_->average, least_loss));
  return terms;
}

RgbLanes Bsdf::evaluate_glossy(const Vec3Lanes& lights, const ViewTerms& terms) const {
  const FloatLanes zero{};
  const IntLanes above = lights.z > 0;
  const Vec3Lanes sum{lights.x + terms.view.x, lights.y + terms.view.y, lights.z + terms.view.z};
  const FloatLanes specular = ggx::reflection(lights, sum, terms.view, terms.lambda, alpha_);
  // Between light and half vector: the sum is twice as long as its cosine.
  const RgbLanes f = fresnel(smaller(0.5F * square_root(dot(sum, sum)), 1.0F));
  const FloatLanes lost = loss_->at(lights.z) * lights.z;
  return {select(above, f.r * specular + lost * terms.lost.x, zero),
          select(above, f.g * specular + lost * terms.lost.y, zero),
          select(above, f.b * specular + lost * terms.lost.z, zero)};
}

namespace {

// Chance of the specular lobe, given what it keeps back from the viewer and the colour of the
// diffuse one.
float specular_chance(float loss, float diffuse_colour) {
  const float specular = 1 - loss;
  const float diffuse = loss * diffuse_colour;
  const float total = specular + diffuse;
  return total > 0 ? std::clamp(specular / total, 0.05F, 0.95F) : 1;
}

}  // namespace

float Bsdf::pdf(const Direction& light, const Direction& view) const {
  if (!(light.z > 0) || !(view.z > 0)) return 0;
  const float diffuse = light.z * inverse_pi;
  if (kind_ == Kind::lambert) return diffuse;
  const Vec3 half_vector = (light + view).normalized();
  const float specular =
      ggx::density(half_vector, alpha_) * ggx::masking(view, alpha_) / (4 * view.z);
  const float chance = specular_chance(
      loss_->at(view.z), max_component(kind_ == Kind::conductor ? multiple_scattering_ : albedo_));
  return chance * specular + (1 - chance) * diffuse;
}

Bsdf::Sample Bsdf::sample(const Direction& view, const std::array<float, 3>& u) const {
  if (!(view.z > 0)) return {};
  if (kind_ == Kind::lambert) {
    const Direction light = cosine_direction(u[1], u[2]);
    return {light, albedo_, light.z * inverse_pi};
  }
  const float chance = specular_chance(
      loss_->at(view.z), max_component(kind_ == Kind::conductor ? multiple_scattering_ : albedo_));
  Direction light;
  if (u[0] < chance) {
    const Vec3 half_vector = ggx::sample_visible_normal(view, alpha_, u[1], u[2]);
    light = (half_vector * (2 * (view ^ half_vector)) - view).normalized();
  } else {
    light = cosine_direction(u[1], u[2]);
  }
  const float density = pdf(light, view);
  if (!(density > 0)) return {};
  return {light, evaluate(light, view) / density, density};
}

}  // namespace weft
