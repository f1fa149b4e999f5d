#include "codecs/cmf/cmf_file.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "btf/sampling_json.h"
#include "codecs/atomic_folder.h"
#include "codecs/cmf/atlas.h"
#include "images/image_file.h"

namespace weft::cmf {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 2;

void write_bytes(const fs::path& path, int width, int height,
                 const std::vector<std::uint8_t>& bytes) {
  Image image(width, height);
  std::ranges::transform(bytes, image.values.begin(), [](std::uint8_t b) { return b / 255.0F; });
  write_image(path, image, Encoding::linear);
}

void write_floats(const fs::path& path, int width, int height, const std::vector<float>& floats) {
  Image image(width, height);
  image.values = floats;
  write_image(path, image, Encoding::linear);
}

// Writes one texture and answers its entry for `arrays`.
Json write_array(const fs::path& folder, const std::string& name, int width, int height,
                 const RgbArray& array) {
  const bool eight_bit = array.floats.empty();
  const std::string file = name + (eight_bit ? ".png" : ".exr");
  if (eight_bit)
    write_bytes(folder / file, width, height, array.bytes);
  else
    write_floats(folder / file, width, height, array.floats);
  return {{"name", name},     {"file", file},  {"width", width},
          {"height", height}, {"channels", 3}, {"type", eight_bit ? "8-bit, 255 is 1" : "float"}};
}

Json write_arrays(const fs::path& folder, const Model& model) {
  Json arrays = Json::array();
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const AtlasLayout layout = atlas_layout(model, f);
    const RgbArray& maps = model.factors[f].maps;
    Json entry =
        write_array(folder, name_of(model.factors[f].projection), layout.width(), layout.height(),
                    {to_atlas(maps.bytes, layout), to_atlas(maps.floats, layout)});
    entry["maps"] = model.map_count(f);
    entry["columns"] = layout.columns;
    entry["layout"] =
        "parabolic maps side by side, row after row; corner texels at (+-1, +-1), row 0 at +y";
    arrays.push_back(entry);
  }
  if (model.clustered) {
    Json entry = write_array(folder, "index", model.width, model.height, {model.index, {}});
    entry["type"] = "8-bit index";
    entry["layout"] = "channel i: the texel's map in array i; unused channels are 0";
    arrays.push_back(entry);
  }
  Json entry = write_array(folder, "scale", model.width, model.height, model.scale);
  entry["maximum"] = {model.scale_max.x, model.scale_max.y, model.scale_max.z};
  entry["layout"] = model.scale.floats.empty() ? "squared, times maximum: 1/sr; row 0 at v near 1"
                                               : "times maximum: 1/sr; row 0 at v near 1";
  arrays.push_back(entry);
  return arrays;
}

// An array's entry of codec.json, by its name.
const Json& entry_named(const Json& arrays, const std::string& name) {
  for (const Json& entry : arrays) {
    if (entry.at("name") == name) return entry;
  }
  throw bad_input("arrays", fmt::format("there is no '{}'", name));
}

RgbArray read_array(const fs::path& folder, const Json& entry, int width, int height) {
  const fs::path path = folder / entry.at("file").get<std::string>();
  Image image = read_image(path, Encoding::linear);
  if (image.width != width || image.height != height || image.channels < 3) {
    throw bad_input(path.string(),
                    fmt::format("is {} x {} with {} channels; codec.json says {} x {} with 3",
                                image.width, image.height, image.channels, width, height));
  }
  if (image.channels != 3) {
    throw bad_input(path.string(), fmt::format("has {} channels; expected 3", image.channels));
  }
  if (entry.at("type") == "float") return {{}, std::move(image.values)};
  return {to_bytes(image.values), {}};
}

Factor read_factor(const fs::path& folder, const Json& arrays, const std::string& name,
                   const Model& model) {
  const Json& entry = entry_named(arrays, name);
  const AtlasLayout layout{entry.at("columns"), entry.at("height").get<int>() / model.resolution,
                           model.resolution};
  const auto maps = entry.at("maps").get<std::size_t>();
  if (layout.columns < 1 || maps > static_cast<std::size_t>(layout.columns) * layout.rows) {
    throw bad_input(name,
                    fmt::format("{} maps do not fit {} x {}", maps, layout.columns, layout.rows));
  }
  const RgbArray atlas = read_array(folder, entry, layout.width(), layout.height());
  Factor factor{Projection::light, {}};
  for (const Projection p : {Projection::light, Projection::half, Projection::view}) {
    if (name_of(p) == name) factor.projection = p;
  }
  if (atlas.floats.empty())
    factor.maps.bytes = from_atlas(atlas.bytes, layout, maps);
  else
    factor.maps.floats = from_atlas(atlas.floats, layout, maps);
  return factor;
}

void check_maps(const Model& model) {
  const std::size_t texels = static_cast<std::size_t>(model.width) * model.height;
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    for (std::size_t texel = 0; texel < texels; ++texel) {
      if (model.map_of(f, texel) < model.map_count(f)) continue;
      throw bad_input(name_of(model.factors[f].projection),
                      fmt::format("texel {} asks for map {} of {}", texel, model.map_of(f, texel),
                                  model.map_count(f)));
    }
  }
}

Model model_from(const fs::path& folder, const Json& json) {
  if (json.at("codec") != "cmf" || json.at("version") != version) {
    throw bad_input("version",
                    fmt::format("{} {}; this build reads cmf {}", json.at("codec").dump(),
                                json.at("version").dump(), version));
  }
  const std::string where = (folder / "codec.json").string();
  Model model{.width = json.at("texels").at(0),
              .height = json.at("texels").at(1),
              .resolution = json.at("resolution"),
              .clustered = json.at("clustered"),
              .factors = {},
              .index = {},
              .scale = {},
              .scale_max = Rgb(0, 0, 0),
              .views = sampling_from_json(json.at("views"), where + ": views"),
              .lights = sampling_from_json(json.at("lights"), where + ": lights"),
              .parameters = json.at("parameters").dump(),
              .provenance = json.at("provenance").dump()};
  if (model.width < 1 || model.height < 1 || model.resolution < 2 || model.resolution > 256) {
    throw bad_input("texels or resolution", fmt::format("{} x {} texels, maps of {}", model.width,
                                                        model.height, model.resolution));
  }
  const Json& arrays = json.at("arrays");
  for (const Json& name : json.at("factors")) {
    if (model.factors.size() == 3) throw bad_input("factors", "names more than three");
    model.factors.push_back(read_factor(folder, arrays, name, model));
  }
  if (model.clustered) {
    model.index = read_array(folder, entry_named(arrays, "index"), model.width, model.height).bytes;
    if (model.index.empty()) throw bad_input("index", "is of type float; expected 8-bit index");
  }
  const Json& scale = entry_named(arrays, "scale");
  model.scale = read_array(folder, scale, model.width, model.height);
  for (int c = 0; c < 3; ++c) model.scale_max[c] = scale.at("maximum").at(c);
  check_maps(model);
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_folder_atomically(folder, [&](const fs::path& aside) {
    Json json{{"codec", "cmf"}, {"version", version}};
    json["parameters"] = Json::parse(model.parameters);
    json["texels"] = {model.width, model.height};
    json["resolution"] = model.resolution;
    json["clustered"] = model.clustered;
    json["factors"] = Json::array();
    for (const Factor& factor : model.factors)
      json["factors"].push_back(name_of(factor.projection));
    json["arrays"] = write_arrays(aside, model);
    json["lights"] = sampling_to_json(model.lights);
    json["views"] = sampling_to_json(model.views);
    json["provenance"] = Json::parse(model.provenance);
    json["files"] = folder_checksums(aside);
    write_text_atomically(aside / "codec.json", json.dump(2) + "\n");
  });
}

Model read_model(const fs::path& folder) {
  const Json json = read_checked_codec_json(folder);
  const std::string where = (folder / "codec.json").string();
  try {
    return model_from(folder, json);
  } catch (const nlohmann::json::exception& error) {
    throw bad_input(where, error.what(), "a field is missing or of another type");
  } catch (const Error& error) {
    if (error.where().starts_with(folder.string())) throw;
    throw bad_input(where, error.what());  // a field's
  }
}

}  // namespace weft::cmf
