// Reads and writes a Laplacian BTF's folder.

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "btf/error.h"
#include "codecs/laplacian/model.h"

namespace weft::laplacian {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;

Json written(const fs::path& folder, const std::string& name, Texel size, Storage storage,
             const std::vector<float>& map, const std::string& layout) {
  Json entry = write_stored(folder, name, size.x, size.y, storage, map);
  entry["layout"] = layout;
  return entry;
}

template <typename Choice>
Choice choice(const Json& json, const char* field, std::initializer_list<Choice> choices) {
  const std::string name = json.at(field);
  for (const Choice c : choices) {
    if (name_of(c) == name) return c;
  }
  throw bad_input(field, fmt::format("'{}' is not known", name));
}

Pyramid pyramid_from(const Json& json, const FittedHead& head) {
  const int levels = json.at("levels");
  if (levels < 1 || levels > most_levels(head.width, head.height) + 1)
    throw bad_input("levels", fmt::format("{} of {} x {} texels", levels, head.width, head.height));
  return {head.width, head.height, levels - 1,
          choice(json, "filters", {Filters::box3, Filters::box2, Filters::linear})};
}

void check_numbers(const Model& model) {
  if (model.scale.size() != model.levels() * model.slots())
    throw bad_input("scale", fmt::format("has {} numbers, expected {}", model.scale.size(),
                                         model.levels() * model.slots()));
  const Phong& phong = model.mean_y;
  std::vector<float> numbers = model.scale;
  numbers.insert(numbers.end(), {phong.ka, phong.kd, phong.ks, phong.alpha, model.mean_chroma[0],
                                 model.mean_chroma[1]});
  for (const float number : numbers) {
    if (!std::isfinite(number)) throw bad_input("scale or mean", "is not finite");
  }
}

Model model_from(const fs::path& folder, const Json& json, FittedHead head) {
  Model model{.head = std::move(head)};
  model.pyramid = pyramid_from(json, model.head);
  model.storage = choice(json, "storage", {Storage::float32, Storage::half, Storage::eight_bit});
  for (std::size_t c = 0; c < 3; ++c) {
    model.components[c] = json.at("components").at(c);
    if (model.components[c] < 1 || model.components[c] > 32)
      throw bad_input("components", fmt::format("{}; expected 1 to 32", model.components[c]));
  }
  model.interpolated = json.at("directions") == "interpolated";
  const Json& mean = json.at("mean");
  model.mean_y = {mean.at("ka"), mean.at("kd"), mean.at("ks"), mean.at("alpha")};
  model.chroma = mean.at("chroma") == "cosine" ? ChromaMean::cosine : ChromaMean::constant;
  model.mean_chroma = {mean.at("cb"), mean.at("cr")};
  model.scale = json.at("scale").get<std::vector<float>>();
  check_numbers(model);
  const Texel eigen = model.eigen_map_size();
  const Texel weights = model.weight_map_size();
  model.set_maps(
      read_stored(folder, json.at("arrays"), "eigen", eigen.x, eigen.y, model.storage),
      read_stored(folder, json.at("arrays"), "weights", weights.x, weights.y, model.storage));
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_fitted(folder, "laplacian", version, model.head, [&](const fs::path& aside) {
    Json arrays = Json::array();
    arrays.push_back(written(aside, "eigen", model.eigen_map_size(), model.storage,
                             model.eigen_map(),
                             "row: level * views + view; column: quad * lights + light"));
    arrays.push_back(written(aside, "weights", model.weight_map_size(), model.storage,
                             model.weight_map(), "blocks of levels and quads, see blocks"));
    Json blocks = Json::array();
    for (int level = 0; level < model.levels(); ++level) {
      Json row = Json::array();
      for (std::size_t quad = 0; quad < model.quads(); ++quad) {
        const Texel block = model.weight_block(level, quad);
        row.push_back({block.x, block.y});
      }
      blocks.push_back(row);
    }
    arrays.back()["blocks"] = blocks;
    return Json{{"storage", name_of(model.storage)},
                {"levels", model.levels()},
                {"filters", name_of(model.pyramid.filters)},
                {"components", model.components},
                {"directions", model.interpolated ? "interpolated" : "nearest"},
                {"mean",
                 {{"ka", model.mean_y.ka},
                  {"kd", model.mean_y.kd},
                  {"ks", model.mean_y.ks},
                  {"alpha", model.mean_y.alpha},
                  {"chroma", model.chroma == ChromaMean::cosine ? "cosine" : "constant"},
                  {"cb", model.mean_chroma[0]},
                  {"cr", model.mean_chroma[1]}}},
                {"scale", model.scale},
                {"arrays", arrays}};
  });
}

Model read_model(const fs::path& folder) {
  std::optional<Model> model;
  read_fitted(folder, "laplacian", version, [&](const Json& json, FittedHead head) {
    model = model_from(folder, json, std::move(head));
  });
  return std::move(*model);
}

}  // namespace weft::laplacian
