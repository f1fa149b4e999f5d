// Numbers in [-1, 1] as textures hold them: 8 bits, half or float. In memory they are the floats
// that come back, so that no decoder converts; on disk and on the GPU what was asked for.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "btf/error.h"
#include "codecs/gl_program.h"
#include "settings/settings.h"

namespace weft {

enum class Storage { eight_bit, half, float32 };

/// The parameter `bits`: half (default), 8 or float.
Storage storage_parameter(const Settings& parameters);
/// "8", "half" or "float".
std::string name_of(Storage storage);
std::size_t bytes_a_value(Storage storage);

/// Rounds to what the storage holds: 8 bits are (byte - 128) / 127.
float stored_value(Storage storage, float value);

/// What a texture's colours are divided by, so that the largest is 8,192: then halfs hold sums of
/// them up to seven times as large. 1 where all are 0; never less than a float holds in full.
/// @param largest  of the colours' absolute values, finite.
float colour_scale(float largest);

/// What a fit is refused with whose numbers are more than a float holds.
/// @param place  of the first of them, such as "view 3, texel (2, 0)".
Error beyond_float(const std::string& place);

/// A texture buffer of four values a texel.
/// @param values  stored ones, a multiple of four.
GlTexture stored_texture(std::string name, Storage storage, const std::vector<float>& values);

/// A GLSL expression for the four values of texel `index` of such a texture.
std::string stored_fetch(const std::string& name, const std::string& index, Storage storage);

/// Writes NAME.exr, or NAME.png where there are 8 bits, of four channels. @return its entry for
/// `arrays` of codec.json.
/// @param values  stored ones, [height][width][4].
nlohmann::ordered_json write_stored(const std::filesystem::path& folder, const std::string& name,
                                    int width, int height, Storage storage,
                                    const std::vector<float>& values);

/// @throws Error  where `arrays` has no such entry, or its file is of another size.
std::vector<float> read_stored(const std::filesystem::path& folder,
                               const nlohmann::ordered_json& arrays, const std::string& name,
                               int width, int height, Storage storage);

}  // namespace weft
