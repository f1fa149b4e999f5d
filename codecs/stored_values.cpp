#include "codecs/stored_values.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "btf/vector.h"
#include "codecs/stencil_glsl.h"
#include "images/image_file.h"

namespace weft {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(127 * std::clamp(value, -1.0F, 1.0F)) + 128);
}

float from_byte(std::uint8_t byte) {
  return static_cast<float>(byte - 128) / 127;
}

std::string file_name(const std::string& name, Storage storage) {
  return name + (storage == Storage::eight_bit ? ".png" : ".exr");
}

}  // namespace

Storage storage_parameter(const Settings& parameters) {
  const std::string bits = parameters.choice("bits", {"half", "8", "float"});
  return bits == "8" ? Storage::eight_bit : bits == "half" ? Storage::half : Storage::float32;
}

std::string name_of(Storage storage) {
  switch (storage) {
    case Storage::eight_bit:
      return "8";
    case Storage::half:
      return "half";
    case Storage::float32:
      return "float";
  }
  return "";
}

std::size_t bytes_a_value(Storage storage) {
  return storage == Storage::eight_bit ? 1 : storage == Storage::half ? 2 : 4;
}

float stored_value(Storage storage, float value) {
  switch (storage) {
    case Storage::eight_bit:
      return from_byte(to_byte(value));
    case Storage::half:
      return half(value);
    case Storage::float32:
      break;
  }
  return value;
}

float colour_scale(float largest) {
  constexpr float held = 8192;
  return largest > 0 ? std::max(largest / held, std::numeric_limits<float>::min()) : 1;
}

Error beyond_float(const std::string& place) {
  return bad_input(
      "BTF", fmt::format("{}: values are so large that their fit is beyond a float's range", place),
      "mend that texel, whose picture weft extract makes, or divide all data by a "
      "power of ten");
}

GlTexture stored_texture(std::string name, Storage storage, const std::vector<float>& values) {
  using Format = GlTexture::Format;
  if (storage == Storage::float32) return buffer_texture(std::move(name), Format::rgba32f, values);
  if (storage == Storage::half) {
    const std::vector<half> halfs(values.begin(), values.end());
    return buffer_texture(std::move(name), Format::rgba16f, halfs);
  }
  std::vector<std::uint8_t> bytes(values.size());
  std::ranges::transform(values, bytes.begin(), to_byte);
  return buffer_texture(std::move(name), Format::rgba8, bytes);
}

std::string stored_fetch(const std::string& name, const std::string& index, Storage storage) {
  const std::string fetch = fmt::format("texelFetch({}, {})", name, index);
  return storage == Storage::eight_bit ? fmt::format("(({} * 255.0 - 128.0) / 127.0)", fetch)
                                       : fetch;
}

Json write_stored(const fs::path& folder, const std::string& name, int width, int height,
                  Storage storage, const std::vector<float>& values) {
  Image image(width, height, 4);
  image.values = values;
  const std::string file = file_name(name, storage);
  if (storage == Storage::eight_bit) {
    std::ranges::transform(values, image.values.begin(),
                           [](float v) { return static_cast<float>(to_byte(v)) / 255; });
  }
  write_image(folder / file, image, Encoding::linear,
              storage == Storage::half ? FloatSize::half : FloatSize::full);
  return {{"name", name},
          {"file", file},
          {"width", width},
          {"height", height},
          {"channels", 4},
          {"type", storage == Storage::eight_bit ? "8-bit, (byte - 128) / 127" : name_of(storage)}};
}

std::vector<float> read_stored(const fs::path& folder, const Json& arrays, const std::string& name,
                               int width, int height, Storage storage) {
  const auto entry =
      std::ranges::find_if(arrays, [&](const Json& array) { return array.at("name") == name; });
  if (entry == arrays.end()) throw bad_input("arrays", fmt::format("there is no '{}'", name));
  const fs::path path = folder / entry->at("file").get<std::string>();
  Image image = read_image(path, Encoding::linear);
  if (image.width != width || image.height != height || image.channels != 4) {
    throw bad_input(path.string(),
                    fmt::format("is {} x {} with {} channels; codec.json asks for {} x {} with 4",
                                image.width, image.height, image.channels, width, height));
  }
  for (float& value : image.values) {
    if (storage == Storage::eight_bit)
      value = from_byte(static_cast<std::uint8_t>(std::lround(value * 255)));
    if (!std::isfinite(value))
      throw bad_input(path.string(), fmt::format("holds {}, expected finite numbers", value));
  }
  return std::move(image.values);
}

}  // namespace weft
