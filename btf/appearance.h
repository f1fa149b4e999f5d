// The one interface by which anything that can be shaded is asked: raw BTFs, compressed ones, plain
// BRDFs.
#pragma once

#include <span>

#include "btf/direction.h"

namespace weft {

/// One question to an `Appearance`.
struct AppearanceQuery {
  Texcoord uv;      ///< repeats with period 1
  Direction light;  ///< unit, local frame, to the light
  Direction view;   ///< unit, local frame, to the viewer
  float lod = 0;    ///< log2(footprint width in texels); 0 is the finest level
};

/// B(uv, light, view) = L_o / E_perp in 1/sr, the cosine of the light included.
class Appearance {
 public:
  virtual ~Appearance() = default;

  /// 0 where light.z <= 0 or view.z <= 0. Bilinear between texel centres. Thread-safe.
  virtual Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const = 0;

  /// Answers many queries; `answers` has the size of `queries`. The default asks them one by one.
  virtual void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const;

  /// False where level 0 answers for every lod.
  virtual bool has_lod() const = 0;

  /// Texels of one tile, columns and rows; (1, 1) for a homogeneous material. Tells a footprint's
  /// lod.
  virtual Imath::V2i texels() const = 0;
};

}  // namespace weft
