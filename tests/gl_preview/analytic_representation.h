// A representation in closed form: answers change with uv and with every component of light and
// view, so that a wrong frame, a swapped axis or a wrong texcoord shows.
#pragma once

#include <numbers>

#include "codecs/representation.h"

class AnalyticRepresentation : public weft::Representation {
 public:
  using Appearance::evaluate;
  weft::Rgb evaluate(weft::Texcoord uv, weft::Direction light, weft::Direction view,
                     float) const override {
    if (light.z <= 0 || view.z <= 0) return weft::Rgb(0, 0, 0);
    const float two_pi = 2 * std::numbers::pi_v<float>;
    const float wave = std::cos(two_pi * uv.x) + 0.5F * std::sin(two_pi * 2 * uv.y);
    return weft::Rgb(0.4F + 0.2F * wave, 0.4F + 0.3F * light.x + 0.2F * view.y,
                     0.4F + 0.3F * light.y - 0.2F * view.x) *
           light.z;
  }
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {64, 64}; }

  std::size_t bytes() const override { return 0; }
  std::size_t constant_bytes() const override { return 0; }
  const weft::HemisphereSampling& views() const override { return sampling_; }
  const weft::HemisphereSampling& lights() const override { return sampling_; }
  std::string codec() const override { return "analytic"; }
  void save(const std::filesystem::path&) const override {}
  weft::GlProgram gl_program() const override {
    return {{}, R"(
      vec3 btf_evaluate(vec2 uv, vec3 light, vec3 view, float lod) {
        if (light.z <= 0.0 || view.z <= 0.0) return vec3(0.0);
        const float two_pi = 6.28318530718;
        float wave = cos(two_pi * uv.x) + 0.5 * sin(two_pi * 2.0 * uv.y);
        return vec3(0.4 + 0.2 * wave, 0.4 + 0.3 * light.x + 0.2 * view.y,
                    0.4 + 0.3 * light.y - 0.2 * view.x) * light.z;
      })"};
  }

 private:
  weft::HemisphereSampling sampling_{{{0, 0, 1}}};
};
