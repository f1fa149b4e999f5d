#include "codecs/factor_maps/model_file.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "btf/sampling_json.h"
#include "codecs/atomic_folder.h"
#include "codecs/factor_maps/atlas.h"
#include "images/image_file.h"

namespace weft::factor_maps {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 3;
constexpr const char* texel_layout = "one texel each; the levels one after another, row by row";

struct Size {
  int width;
  int height;
  int channels;

  std::size_t values() const { return static_cast<std::size_t>(width) * height * channels; }
};

// Writes one texture, zeros filled in at its end, and answers its entry for `arrays`.
Json write_array(const fs::path& folder, const std::string& name, const Size& size,
                 const ValueArray& array) {
  const bool eight_bit = array.floats.empty();
  const std::string file = name + (eight_bit ? ".png" : ".exr");
  Image image(size.width, size.height, size.channels);
  if (eight_bit) {
    std::ranges::transform(array.bytes, image.values.begin(),
                           [](std::uint8_t b) { return static_cast<float>(b) / 255.0F; });
  } else {
    std::ranges::copy(array.floats, image.values.begin());
  }
  write_image(folder / file, image, Encoding::linear);
  return {{"name", name},
          {"file", file},
          {"width", size.width},
          {"height", size.height},
          {"channels", size.channels},
          {"type", eight_bit ? "8-bit, 255 is 1" : "float"}};
}

Size texel_size(const Model& model, int channels) {
  return {model.width(), texel_rows(model), channels};
}

// Three channels of the index map from `first` on.
std::vector<std::uint8_t> index_texture(const Model& model, std::size_t first) {
  std::vector<std::uint8_t> texture(3 * model.texels());
  for (std::size_t i = 0; i < texture.size(); ++i) {
    texture[i] = model.index[model.index_channels() * (i / 3) + first + i % 3];
  }
  return texture;
}

Json index_entry(const fs::path& folder, const Model& model, std::size_t first) {
  const std::string name = first == 0 ? "index" : "index_2";
  Json entry = write_array(folder, name, texel_size(model, 3), {index_texture(model, first), {}});
  entry["type"] = "8-bit index";
  entry["layout"] = fmt::format("channel i: the texel's map in factor {}i; unused are 0; {}",
                                first == 0 ? "" : "3 + ", texel_layout);
  return entry;
}

Json write_arrays(const fs::path& folder, const Model& model) {
  Json arrays = Json::array();
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const AtlasLayout layout = atlas_layout(model, f);
    const ValueArray& maps = model.factors[f].maps;
    Json entry = write_array(folder, name_of(model.factors[f].projection),
                             {layout.width(), layout.height(), 3},
                             {to_atlas(maps.bytes, layout), to_atlas(maps.floats, layout)});
    entry["maps"] = model.map_count(f);
    entry["columns"] = layout.columns;
    entry["terms"] = layout.terms;
    entry["layout"] =
        "parabolic maps side by side, row after row, a map's terms below each other; corner texels "
        "at (+-1, +-1), row 0 at +y";
    arrays.push_back(entry);
  }
  if (model.clustered) {
    for (std::size_t first = 0; first < model.index_channels(); first += 3) {
      arrays.push_back(index_entry(folder, model, first));
    }
  }
  if (!model.rotation.empty()) {
    Json entry = write_array(folder, "rotation", texel_size(model, 1), {model.rotation, {}});
    entry["type"] = "8-bit index";
    entry["layout"] = fmt::format("directions are turned back by this many {}ths of a circle; {}",
                                  rotation_steps, texel_layout);
    arrays.push_back(entry);
  }
  Json entry = write_array(folder, "scale", texel_size(model, 3), model.scale);
  entry["maximum"] = {model.scale_max.x, model.scale_max.y, model.scale_max.z};
  entry["layout"] = fmt::format("{}times maximum: 1/sr; row 0 at v near 1; {}",
                                model.scale.floats.empty() ? "squared, " : "", texel_layout);
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

ValueArray read_array(const fs::path& folder, const Json& entry, const Size& size) {
  const fs::path path = folder / entry.at("file").get<std::string>();
  Image image = read_image(path, Encoding::linear);
  if (image.width != size.width || image.height != size.height || image.channels != size.channels) {
    throw bad_input(path.string(), fmt::format("is {} x {} with {} channels; codec.json says {} x "
                                               "{} with {}",
                                               image.width, image.height, image.channels,
                                               size.width, size.height, size.channels));
  }
  if (entry.at("type") == "float") return {{}, std::move(image.values)};
  return {to_bytes(image.values), {}};
}

// One value or more a texel of any level.
ValueArray read_texels(const fs::path& folder, const Json& arrays, const std::string& name,
                       const Model& model, int channels) {
  ValueArray array = read_array(folder, entry_named(arrays, name), texel_size(model, channels));
  const std::size_t count = channels * model.texels();
  if (array.floats.empty())
    array.bytes.resize(count);
  else
    array.floats.resize(count);
  return array;
}

std::vector<std::uint8_t> read_indices(const fs::path& folder, const Json& arrays,
                                       const std::string& name, const Model& model, int channels) {
  std::vector<std::uint8_t> bytes = read_texels(folder, arrays, name, model, channels).bytes;
  if (bytes.empty()) throw bad_input(name, "is of type float; expected 8-bit index");
  return bytes;
}

Factor read_factor(const fs::path& folder, const Json& arrays, const std::string& name,
                   const Model& model) {
  const Json& entry = entry_named(arrays, name);
  const int terms = entry.at("terms");
  if (terms < 1 || terms > max_terms) throw bad_input(name, fmt::format("has {} terms", terms));
  const AtlasLayout layout{entry.at("columns"),
                           entry.at("height").get<int>() / (terms * model.resolution),
                           model.resolution, terms};
  const auto maps = entry.at("maps").get<std::size_t>();
  if (layout.columns < 1 || layout.rows < 1 || maps < 1 ||
      maps > static_cast<std::size_t>(layout.columns) * layout.rows) {
    throw bad_input(name,
                    fmt::format("{} maps do not fit {} x {}", maps, layout.columns, layout.rows));
  }
  const ValueArray atlas = read_array(folder, entry, {layout.width(), layout.height(), 3});
  Factor factor{projection_named(name), terms, {}};
  if (atlas.floats.empty())
    factor.maps.bytes = from_atlas(atlas.bytes, layout, maps);
  else
    factor.maps.floats = from_atlas(atlas.floats, layout, maps);
  return factor;
}

void check_factors(const Model& model) {
  if (model.factors.empty()) throw bad_input("factors", "names none");
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    const Factor& factor = model.factors[f];
    if (f > 0 && !(model.factors[f - 1].projection < factor.projection)) {
      throw bad_input("factors", "are not in the order light, half, difference, view");
    }
    for (const Factor& other : model.factors) {
      if (link_of(other.projection) == link_of(factor.projection) && other.terms != factor.terms) {
        throw bad_input(name_of(factor.projection),
                        fmt::format("has {} terms, {} has {}", factor.terms,
                                    name_of(other.projection), other.terms));
      }
      if (other.maps.floats.empty() != factor.maps.floats.empty()) {
        throw bad_input(name_of(factor.projection), "is of another type than the other factors");
      }
    }
  }
}

void check_maps(const Model& model) {
  for (std::size_t f = 0; f < model.factors.size(); ++f) {
    for (std::size_t texel = 0; texel < model.texels(); ++texel) {
      if (model.map_of(f, texel) < model.map_count(f)) continue;
      throw bad_input(name_of(model.factors[f].projection),
                      fmt::format("texel {} asks for map {} of {}", texel, model.map_of(f, texel),
                                  model.map_count(f)));
    }
  }
}

void read_index(const fs::path& folder, const Json& arrays, Model& model) {
  model.index.resize(model.index_channels() * model.texels());
  for (std::size_t first = 0; first < model.index_channels(); first += 3) {
    const auto texture = read_indices(folder, arrays, first == 0 ? "index" : "index_2", model, 3);
    for (std::size_t i = 0; i < texture.size(); ++i) {
      model.index[model.index_channels() * (i / 3) + first + i % 3] = texture[i];
    }
  }
}

std::vector<Level> read_levels(const Json& json) {
  const int width = json.at("texels").at(0);
  const int height = json.at("texels").at(1);
  if (width < 1 || height < 1) {
    throw bad_input("texels", fmt::format("{} x {}", width, height));
  }
  std::vector<Level> levels = mip_levels(width, height);
  const auto count = json.at("levels").get<std::size_t>();
  if (count < 1 || count > levels.size()) {
    throw bad_input("levels", fmt::format("{}; the tile has {}", count, levels.size()));
  }
  levels.resize(count);
  return levels;
}

Model model_from(const fs::path& folder, const Json& json, const std::string& codec) {
  if (json.at("codec") != codec || json.at("version") != version) {
    throw bad_input("version", fmt::format("{} {}; this build reads {} {}", json.at("codec").dump(),
                                           json.at("version").dump(), codec, version));
  }
  const std::string where = (folder / "codec.json").string();
  Model model{.codec = codec,
              .levels = read_levels(json),
              .resolution = json.at("resolution"),
              .clustered = json.at("clustered"),
              .factors = {},
              .index = {},
              .rotation = {},
              .scale = {},
              .scale_max = Rgb(0, 0, 0),
              .views = sampling_from_json(json.at("views"), where + ": views"),
              .lights = sampling_from_json(json.at("lights"), where + ": lights"),
              .parameters = json.at("parameters").dump(),
              .provenance = json.at("provenance").dump()};
  if (model.resolution < 2 || model.resolution > 256) {
    throw bad_input("resolution", fmt::format("maps of {}", model.resolution));
  }
  const Json& arrays = json.at("arrays");
  for (const Json& name : json.at("factors")) {
    if (model.factors.size() == max_factors) throw bad_input("factors", "names more than four");
    model.factors.push_back(read_factor(folder, arrays, name, model));
  }
  check_factors(model);
  if (model.clustered) read_index(folder, arrays, model);
  if (json.at("rotated").get<bool>()) {
    model.rotation = read_indices(folder, arrays, "rotation", model, 1);
  }
  model.scale = read_texels(folder, arrays, "scale", model, 3);
  const Json& scale = entry_named(arrays, "scale");
  for (int c = 0; c < 3; ++c) model.scale_max[c] = scale.at("maximum").at(c);
  check_maps(model);
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_folder_atomically(folder, [&](const fs::path& aside) {
    Json json{{"codec", model.codec}, {"version", version}};
    json["parameters"] = Json::parse(model.parameters);
    json["texels"] = {model.width(), model.height()};
    json["levels"] = model.levels.size();
    json["resolution"] = model.resolution;
    json["clustered"] = model.clustered;
    json["rotated"] = !model.rotation.empty();
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

Model read_model(const fs::path& folder, const std::string& codec) {
  const Json json = read_checked_codec_json(folder);
  const std::string where = (folder / "codec.json").string();
  try {
    return model_from(folder, json, codec);
  } catch (const nlohmann::json::exception& error) {
    throw bad_input(where, error.what(), "a field is missing or of another type");
  } catch (const Error& error) {
    if (error.where().starts_with(folder.string())) throw;
    throw bad_input(where, error.what());  // a field's
  }
}

}  // namespace weft::factor_maps
