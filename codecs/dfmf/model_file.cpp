// Reads and writes a DFMF's folder.

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "btf/error.h"
#include "codecs/dfmf/model.h"

namespace weft::dfmf {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;

int basis_width(const Model& model) {
  return static_cast<int>(model.head.lights.size() * model.slots() / 4);
}
int weights_width(const Model& model) {
  return static_cast<int>(model.head.width * model.slots() / 4);
}

Model model_from(const fs::path& folder, const Json& json, FittedHead head) {
  Model model{.head = std::move(head)};
  const std::string storage = json.at("storage");
  for (const Storage s : {Storage::eight_bit, Storage::half, Storage::float32}) {
    if (name_of(s) == storage) model.storage = s;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    model.components[c] = json.at("components").at(c);
    if (model.components[c] < 1 || model.components[c] > 256)
      throw bad_input("components", fmt::format("{}; expected 1 to 256", model.components[c]));
  }
  model.epsilon = json.at("epsilon");
  model.scale = json.at("scale").get<std::vector<float>>();
  if (model.scale.size() != model.slots())
    throw bad_input("scale",
                    fmt::format("has {} numbers, expected {}", model.scale.size(), model.slots()));
  const Json& arrays = json.at("arrays");
  model.weights = read_stored(folder, arrays, "weights", weights_width(model), model.head.height,
                              model.storage);
  model.basis = read_stored(folder, arrays, "basis", basis_width(model),
                            static_cast<int>(model.head.views.size()), model.storage);
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_fitted(folder, "dfmf", version, model.head, [&](const fs::path& aside) {
    Json weights = write_stored(aside, "weights", weights_width(model), model.head.height,
                                model.storage, model.weights);
    weights["layout"] = "row: texel row; column: texel column, slot / 4";
    Json basis =
        write_stored(aside, "basis", basis_width(model), static_cast<int>(model.head.views.size()),
                     model.storage, model.basis);
    basis["layout"] = "row: view; column: light, slot / 4";
    return Json{{"storage", name_of(model.storage)},
                {"components", model.components},
                {"epsilon", model.epsilon},
                {"scale", model.scale},
                {"arrays", Json::array({weights, basis})}};
  });
}

Model read_model(const fs::path& folder) {
  std::optional<Model> model;
  read_fitted(folder, "dfmf", version, [&](const Json& json, FittedHead head) {
    model = model_from(folder, json, std::move(head));
  });
  return std::move(*model);
}

}  // namespace weft::dfmf
