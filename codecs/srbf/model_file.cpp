// Reads and writes an SRBF model's folder.

#include <fmt/core.h>

#include <cmath>
#include <optional>

#include "btf/error.h"
#include "codecs/srbf/model.h"

namespace weft::srbf {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

constexpr int version = 1;
constexpr std::size_t most_kernels = 64;
constexpr const char* over_cosine = "B / cos(theta_light)";

std::size_t number(const Json& json, const char* field, std::size_t most) {
  const std::size_t value = json.at(field);
  if (value < 1 || value > most)
    throw bad_input(field, fmt::format("{}; expected 1 to {}", value, most));
  return value;
}

// Whether a field has the second of two names.
bool is_second(const Json& json, const char* field, const std::string& first,
               const std::string& second) {
  const std::string name = json.at(field);
  if (name != first && name != second)
    throw bad_input(field, fmt::format("'{}'; expected '{}' or '{}'", name, first, second));
  return name == second;
}

void check_scales(const Model& model) {
  if (model.scale.size() != model.row())
    throw bad_input("scale",
                    fmt::format("has {} numbers, expected {}", model.scale.size(), model.row()));
  for (const float scale : model.scale) {
    if (!std::isfinite(scale)) throw bad_input("scale", "is not finite");
  }
}

Model model_from(const fs::path& folder, const Json& json, FittedHead head) {
  Model model{.head = std::move(head)};
  const std::string storage = json.at("storage");
  for (const Storage s : {Storage::eight_bit, Storage::half, Storage::float32}) {
    if (name_of(s) == storage) model.storage = s;
  }
  model.shape = {number(json, "kernels", most_kernels), number(json, "modes", most_modes)};
  model.quantity =
      is_second(json, "quantity", "B", over_cosine) ? Quantity::over_cosine : Quantity::radiance;
  model.filtering =
      is_second(json, "filtering", name_of(Filtering::values), name_of(Filtering::numbers))
          ? Filtering::numbers
          : Filtering::values;
  model.report = json.at("report").dump();
  model.scale = json.at("scale").get<std::vector<float>>();
  check_scales(model);
  model.values =
      read_stored(folder, json.at("arrays"), "kernels", static_cast<int>(model.layout().quads()),
                  static_cast<int>(model.texels()), model.storage);
  return model;
}

}  // namespace

void write_model(const fs::path& folder, const Model& model) {
  write_fitted(folder, "srbf", version, model.head, [&](const fs::path& aside) {
    Json entry = write_stored(aside, "kernels", static_cast<int>(model.layout().quads()),
                              static_cast<int>(model.texels()), model.storage, model.values);
    entry["layout"] =
        "row: texel, level 0 first; column: four kernels' p of each mode (xyz), then colours "
        "(rgb), for each four; last the angles in radians; times scale";
    return Json{{"storage", name_of(model.storage)},
                {"kernels", model.shape.kernels},
                {"modes", model.shape.modes},
                {"quantity", model.quantity == Quantity::radiance ? "B" : over_cosine},
                {"filtering", name_of(model.filtering)},
                {"levels", model.sizes().levels()},
                {"scale", model.scale},
                {"report", Json::parse(model.report)},
                {"arrays", Json::array({entry})}};
  });
}

Model read_model(const fs::path& folder) {
  std::optional<Model> model;
  read_fitted(folder, "srbf", version, [&](const Json& json, FittedHead head) {
    model = model_from(folder, json, std::move(head));
  });
  return std::move(*model);
}

}  // namespace weft::srbf
