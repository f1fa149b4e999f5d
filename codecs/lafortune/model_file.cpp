// Reads and writes the folder of a Lafortune fit.

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "btf/error.h"
#include "codecs/lafortune/model.h"

namespace weft::lafortune {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;

Model model_from(const fs::path& folder, const Json& json, FittedHead head) {
  Model model{.head = std::move(head)};
  const std::string storage = json.at("storage");
  if (storage != "half" && storage != "float")
    throw bad_input("storage", fmt::format("'{}'; expected half or float", storage));
  model.storage = storage == "half" ? Storage::half : Storage::float32;
  model.lobes = json.at("lobes");
  if (model.lobes < 1 || model.lobes > 3)
    throw bad_input("lobes", fmt::format("{}; expected 1 to 3", model.lobes));
  model.scale = json.at("scale");
  if (!(model.scale > 0) || !std::isfinite(model.scale))
    throw bad_input("scale", fmt::format("{}; expected a number > 0", model.scale));
  model.texels = read_stored(folder, json.at("arrays"), "texels",
                             static_cast<int>(model.head.width * model.quads()), model.head.height,
                             model.storage);
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_fitted(folder, "lafortune", version, model.head, [&](const fs::path& aside) {
    Json array = write_stored(aside, "texels", static_cast<int>(model.head.width * model.quads()),
                              model.head.height, model.storage, model.texels);
    array["layout"] = "column: texel column, lobe (Cx, Cy, Cz, n), then RGB and the diffuse term";
    return Json{{"storage", name_of(model.storage)},
                {"lobes", model.lobes},
                {"scale", model.scale},
                {"arrays", Json::array({array})}};
  });
}

Model read_model(const fs::path& folder) {
  std::optional<Model> model;
  read_fitted(folder, "lafortune", version, [&](const Json& json, FittedHead head) {
    model = model_from(folder, json, std::move(head));
  });
  return std::move(*model);
}

}  // namespace weft::lafortune
