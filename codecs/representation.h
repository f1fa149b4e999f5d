// What every codec makes and every part that shades can ask; raw BTFs are codec zero.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "btf/appearance.h"
#include "btf/btf.h"
#include "btf/progress.h"
#include "codecs/gl_program.h"
#include "settings/settings.h"

namespace weft {

class Representation : public Appearance {
 public:
  /// Texture bytes as uploaded, uncompressed, mips included.
  virtual std::size_t bytes() const = 0;
  /// Direction tables and scalars beside the textures.
  virtual std::size_t constant_bytes() const = 0;
  /// The samplings that it was fitted to.
  virtual const HemisphereSampling& views() const = 0;
  virtual const HemisphereSampling& lights() const = 0;
  /// Name of its codec, as in the registry.
  virtual std::string codec() const = 0;
  /// Writes the folder (textures, then codec.json). @throws Error
  virtual void save(const std::filesystem::path& folder) const = 0;
  virtual GlProgram gl_program() const = 0;
};

/// ratio = 3 W H views lights / bytes: the papers' 24-bit input against what is uploaded. `pairs` =
/// views x lights.
double compression_ratio(Imath::V2i texels, std::size_t pairs, std::size_t bytes);
double compression_ratio(const Representation& representation);

/// One row of the registry.
struct Codec {
  std::string name;        ///< as in `--codec NAME`
  std::string summary;     ///< one line
  std::string reference;   ///< paper or section
  std::string parameters;  ///< lines "name = default   meaning", for `weft list codecs`
  /// Fits to a BTF. `parameters` is finished (unknown keys refused) by the codec. @throws Error
  std::function<std::unique_ptr<Representation>(std::shared_ptr<const Btf>,
                                                const Settings& parameters, Progress&)>
      fit;
  /// Opens a folder that `save` wrote. @throws Error
  std::function<std::unique_ptr<Representation>(const std::filesystem::path&)> load;
  /// What a fit with default parameters works with for each texel, beside the data and what lies in
  /// their `MemoryBudget`, with half as much again to spare.
  std::size_t fit_bytes_a_texel = 1024;
  /// The same for each texel and view, of codecs whose result grows with both.
  std::size_t fit_bytes_a_texel_and_view = 0;
};

/// Every codec, `raw` first. The table is in registry.cpp, a line a codec.
std::span<const Codec> codecs();

/// @throws Error  listing the valid names, the nearest first.
const Codec& codec_named(const std::string& name);

/// Opens a dataset folder of any kind: `btf.json` (raw) or `codec.json` (its codec's name is in
/// it).
/// @throws Error  naming the folder where it is neither.
std::unique_ptr<Representation> open_representation(const std::filesystem::path& folder);

}  // namespace weft
