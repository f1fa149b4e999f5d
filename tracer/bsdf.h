// The reflection of a point of a modelled surface: Lambert, GGX conductor, GGX plastic.
//
// All act in a local frame whose +z is the shading normal on the side of the viewer; materials are
// two-sided. `alpha` is the GGX width itself, not a square or a root.
#pragma once

#include <array>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "btf/direction.h"
#include "settings/settings.h"
#include "tracer/lanes.h"

namespace weft {

class Bsdf {
 public:
  enum class Kind { lambert, conductor, plastic };

  /// @param albedo  in [0, 1].
  static Bsdf lambert(const Rgb& albedo);
  /// GGX conductor with exact Fresnel of eta + i k, and multiple scattering after Kulla and Conty.
  static Bsdf conductor(const Rgb& eta, const Rgb& k, float alpha);
  /// The same with Schlick's Fresnel of reflectance f0 at normal incidence.
  static Bsdf conductor_f0(const Rgb& f0, float alpha);
  /// A rough dielectric coat over a diffuse base; albedo 1 sends back all light.
  static Bsdf plastic(const Rgb& albedo, float ior, float alpha);

  Kind kind() const { return kind_; }

  /// f(light, view) * light.z in 1/sr; 0 unless light.z > 0 and view.z > 0.
  Rgb evaluate(const Direction& light, const Direction& view) const;

  /// What depends on the view alone, for many lights.
  struct ViewTerms {
    Direction view;
    float lambda = 0;  ///< of the view, see ggx::lambda
    Rgb lost;          ///< of the lobe of multiple reflections: all but the light's factor
  };
  ViewTerms view_terms(const Direction& view) const;
  /// `evaluate` for sixteen lights.
  RgbLanes evaluate(const Vec3Lanes& lights, const ViewTerms& terms) const {
    const FloatLanes zero{};
    if (!(terms.view.z > 0)) return {zero, zero, zero};
    if (kind_ != Kind::lambert) return evaluate_glossy(lights, terms);
    const FloatLanes cosine = select(lights.z > 0, lights.z, zero) * std::numbers::inv_pi_v<float>;
    return {cosine * albedo_.x, cosine * albedo_.y, cosine * albedo_.z};
  }

  struct Sample {
    Direction light;
    Rgb weight;     ///< f * cos / pdf
    float pdf = 0;  ///< per sr; 0: no sample, the path ends
  };
  /// Draws a light direction for `view`. `u` in [0, 1)^3: a choice of lobe, and two for the
  /// direction.
  Sample sample(const Direction& view, const std::array<float, 3>& u) const;
  /// Density of `sample` at `light`, per sr.
  float pdf(const Direction& light, const Direction& view) const;

 private:
  Kind kind_ = Kind::lambert;
  Rgb albedo_{0, 0, 0};
  Rgb eta_{1, 1, 1};
  Rgb k_{0, 0, 0};
  Rgb f0_{0, 0, 0};
  bool schlick_ = false;
  float ior_ = 1.5F;
  float alpha_ = 1;
  /// What the specular lobe keeps back against the cosine, and the cosine-weighted mean of it.
  struct LossTable;
  std::shared_ptr<const LossTable> loss_;
  Rgb multiple_scattering_{0, 0, 0};

  RgbLanes evaluate_glossy(const Vec3Lanes& lights, const ViewTerms& terms) const;
  Rgb fresnel(float cosine) const;
  RgbLanes fresnel(const FloatLanes& cosine) const;
};

/// Reads `type = "lambert" | "conductor" | "plastic"` and its parameters (design page, "Text
/// files").
Bsdf read_bsdf(const Settings& settings);

}  // namespace weft
