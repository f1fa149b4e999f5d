// A raw BTF as a Representation: btf/'s interpolation on the CPU, texture buffers of all samples on
// the GPU.
#pragma once

#include "btf/raw_appearance.h"
#include "codecs/representation.h"
#include "codecs/stencil_batch.h"

namespace weft {

/// Texture bytes of a raw BTF with its mip levels, from its sizes alone; `pairs` = views x lights.
std::size_t raw_texture_bytes(int width, int height, std::size_t pairs, PixelType type);

class RawRepresentation : public Representation {
 public:
  explicit RawRepresentation(std::shared_ptr<const Btf> btf);

  using Appearance::evaluate;
  Rgb evaluate(Texcoord uv, Direction light, Direction view, float lod) const override {
    return appearance_.evaluate(uv, light, view, lod);
  }
  void evaluate(std::span<const AppearanceQuery> queries, std::span<Rgb> answers) const override;
  bool has_lod() const override { return appearance_.has_lod(); }
  Imath::V2i texels() const override { return appearance_.texels(); }

  std::size_t bytes() const override;
  std::size_t constant_bytes() const override;
  const HemisphereSampling& views() const override { return btf().views(); }
  const HemisphereSampling& lights() const override { return btf().lights(); }
  std::string codec() const override { return "raw"; }
  /// Writes a `.btf` folder, which is what `read_btf` opens.
  void save(const std::filesystem::path& folder) const override;
  /// @throws Error  where the samples are more than a texture buffer of 2^27 texels holds.
  GlProgram gl_program() const override;

  /// The finest level: the data itself.
  const Btf& btf() const { return *appearance_.levels()[0]; }

 private:
  Batch<Rgb> decode(const QueryBatch& batch) const;

  RawAppearance appearance_;
  BatchLocator view_locator_;
  BatchLocator light_locator_;
  std::vector<float> inverse_cosines_;  // of the lights
};

}  // namespace weft
