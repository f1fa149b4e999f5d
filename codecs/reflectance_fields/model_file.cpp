// Reads and writes the folder of reflectance fields.

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "btf/error.h"
#include "codecs/reflectance_fields/model.h"

namespace weft::reflectance_fields {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;

int map_width(const Model& model) {
  return static_cast<int>(model.head.width * model.quads());
}
int map_height(const Model& model) {
  return static_cast<int>(model.head.height * model.head.views.size());
}

Kind kind_of(const Json& json) {
  const std::string name = json.at("kind");
  for (const Kind kind :
       {Kind::lobes, Kind::luminance, Kind::luminance_cosine, Kind::rgb, Kind::rgb_cosine}) {
    if (name_of(kind) == name) return kind;
  }
  throw bad_input("kind", fmt::format("'{}' is not known", name));
}

Storage storage_of(const Json& json) {
  const std::string name = json.at("storage");
  for (const Storage s : {Storage::half, Storage::float32}) {
    if (name_of(s) == name) return s;
  }
  throw bad_input("storage", fmt::format("'{}'; expected half or float", name));
}

Model model_from(const fs::path& folder, const std::string& codec, const Json& json,
                 FittedHead head) {
  Model model{.codec = codec, .head = std::move(head)};
  model.storage = storage_of(json);
  model.kind = kind_of(json);
  model.lobes = json.at("lobes");
  const bool is_lobes = model.kind == Kind::lobes;
  if (is_lobes != (codec == "lobes") || model.lobes > 4 || is_lobes != (model.lobes > 0))
    throw bad_input("kind", fmt::format("{} with {} lobes", name_of(model.kind), model.lobes));
  model.scale = json.at("scale");
  if (!(model.scale > 0) || !std::isfinite(model.scale))
    throw bad_input("scale", fmt::format("{}; expected a number > 0", model.scale));
  model.fields = read_stored(folder, json.at("arrays"), "fields", map_width(model),
                             map_height(model), model.storage);
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_fitted(folder, model.codec, version, model.head, [&](const fs::path& aside) {
    Json array = write_stored(aside, "fields", map_width(model), map_height(model), model.storage,
                              model.fields);
    array["layout"] = "row: view * texel rows + row; column: texel column, quad";
    return Json{{"storage", name_of(model.storage)},
                {"kind", name_of(model.kind)},
                {"lobes", model.lobes},
                {"scale", model.scale},
                {"arrays", Json::array({array})}};
  });
}

Model read_model(const fs::path& folder, const std::string& codec) {
  std::optional<Model> model;
  read_fitted(folder, codec, version, [&](const Json& json, FittedHead head) {
    model = model_from(folder, codec, json, std::move(head));
  });
  return std::move(*model);
}

}  // namespace weft::reflectance_fields
