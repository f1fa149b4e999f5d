// Factor maps on disk: `codec.json` beside the textures, as PNG (8 bits, raw linear bytes) or EXR
// (float).
#pragma once

#include <filesystem>
#include <string>

#include "codecs/factor_maps/model.h"

namespace weft::factor_maps {

/// Whole or not at all. @throws Error
void write_model(const std::filesystem::path& folder, const Model& model);

/// @param codec    that the folder must be of.
/// @throws Error   naming the file, and the field where it is one of codec.json's.
Model read_model(const std::filesystem::path& folder, const std::string& codec);

}  // namespace weft::factor_maps
