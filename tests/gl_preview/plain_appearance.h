// Appearances whose answers are known in closed form.
#pragma once

#include <cmath>
#include <numbers>

#include "btf/appearance.h"

/// A flat Lambertian surface.
class LambertAppearance : public weft::Appearance {
 public:
  explicit LambertAppearance(weft::Rgb albedo) : albedo_(albedo) {}
  using Appearance::evaluate;
  weft::Rgb evaluate(weft::Texcoord, weft::Direction light, weft::Direction view,
                     float) const override {
    if (light.z <= 0 || view.z <= 0) return weft::Rgb(0, 0, 0);
    return albedo_ * (light.z / std::numbers::pi_v<float>);
  }
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {1, 1}; }

 private:
  weft::Rgb albedo_;
};

/// A glossy isotropic lobe about the half vector, of width `alpha` (the slope of Beckmann's
/// distribution).
class GlossyAppearance : public weft::Appearance {
 public:
  explicit GlossyAppearance(float alpha) : alpha_(alpha) {}
  using Appearance::evaluate;
  weft::Rgb evaluate(weft::Texcoord, weft::Direction light, weft::Direction view,
                     float) const override {
    if (light.z <= 0 || view.z <= 0) return weft::Rgb(0, 0, 0);
    const weft::Vec3 half = (light + view).normalized();
    const float tan2 = (1 - half.z * half.z) / (half.z * half.z);
    const float fresnel = 0.1F + 0.9F * std::pow(1 - light.dot(half), 5.0F);
    const float value = std::exp(-tan2 / (alpha_ * alpha_)) * fresnel * light.z;
    return weft::Rgb(value, 0.5F * value, 0.1F * value + 0.05F * light.z);
  }
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {1, 1}; }

 private:
  float alpha_;
};
