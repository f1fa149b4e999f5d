// Reads and writes a PCA's folder.

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "btf/error.h"
#include "codecs/pca/model.h"

namespace weft::pca {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;

struct Size {
  int width;
  int height;
};

Size weights_size(const Model& model) {
  return {static_cast<int>(model.head.width * model.padded() / 4),
          static_cast<int>(model.head.height * model.sets)};
}
Size basis_size(const Model& model) {
  return {static_cast<int>(model.head.lights.size() * 3 * model.padded() / 4),
          static_cast<int>(model.head.views.size())};
}
Size mean_size(const Model& model) {
  return {static_cast<int>(model.head.lights.size()), static_cast<int>(model.head.views.size())};
}

Json written(const fs::path& folder, const std::string& name, Size size, Storage storage,
             const std::vector<float>& values, const std::string& layout) {
  Json entry = write_stored(folder, name, size.width, size.height, storage, values);
  entry["layout"] = layout;
  return entry;
}

void check_scales(const Model& model, std::size_t expected) {
  if (model.scale.size() != expected) {
    throw bad_input("scale",
                    fmt::format("has {} numbers, expected {}", model.scale.size(), expected));
  }
  for (const float scale : model.scale) {
    if (!std::isfinite(scale)) throw bad_input("scale", "is not finite");
  }
}

Model model_from(const fs::path& folder, const std::string& codec, const Json& json,
                 FittedHead head) {
  Model model{.codec = codec, .head = std::move(head)};
  const std::string storage = json.at("storage");
  for (const Storage s : {Storage::eight_bit, Storage::half, Storage::float32}) {
    if (name_of(s) == storage) model.storage = s;
  }
  model.components = json.at("components");
  model.sets = codec == "pca" ? 1 : model.head.views.size();
  if (model.components < 1 || model.components > 256)
    throw bad_input("components", fmt::format("{}; expected 1 to 256", model.components));
  const Json& arrays = json.at("arrays");
  const auto values = [&](const std::string& name, Size size, Storage s) {
    return read_stored(folder, arrays, name, size.width, size.height, s);
  };
  model.weights = values("weights", weights_size(model), model.storage);
  model.basis = values("basis", basis_size(model), model.storage);
  model.mean = values("mean", mean_size(model), model.mean_storage());
  model.scale = json.at("scale").get<std::vector<float>>();
  model.mean_scale = json.at("mean_scale");
  check_scales(model, model.sets * model.padded());
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_fitted(folder, model.codec, version, model.head, [&](const fs::path& aside) {
    Json arrays = Json::array();
    arrays.push_back(written(aside, "weights", weights_size(model), model.storage, model.weights,
                             "row: set * texel rows + row; column: texel column, component / 4"));
    arrays.push_back(written(aside, "basis", basis_size(model), model.storage, model.basis,
                             "row: view; column: light, channel, component / 4"));
    arrays.push_back(written(aside, "mean", mean_size(model), model.mean_storage(), model.mean,
                             "row: view; column: light; RGB times mean_scale: 1/sr"));
    return Json{{"storage", name_of(model.storage)},
                {"components", model.components},
                {"arrays", arrays},
                {"scale", model.scale},
                {"mean_scale", model.mean_scale}};
  });
}

Model read_model(const fs::path& folder, const std::string& codec) {
  std::optional<Model> model;
  read_fitted(folder, codec, version, [&](const Json& json, FittedHead head) {
    model = model_from(folder, codec, json, std::move(head));
  });
  return std::move(*model);
}

}  // namespace weft::pca
