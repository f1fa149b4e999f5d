// A CMF on disk: `codec.json` beside the textures, as PNG (8 bits, raw linear bytes) or EXR
// (float).
#pragma once

#include <filesystem>

#include "codecs/cmf/model.h"

namespace weft::cmf {

/// Whole or not at all. @throws Error
void write_model(const std::filesystem::path& folder, const Model& model);

/// @throws Error  naming the file, and the field where it is one of codec.json's.
Model read_model(const std::filesystem::path& folder);

}  // namespace weft::cmf
