#include "codecs/reflectance_fields/model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace weft::reflectance_fields {

std::string name_of(Kind kind) {
  switch (kind) {
    case Kind::lobes:
      return "lobes";
    case Kind::luminance:
      return "luminance";
    case Kind::luminance_cosine:
      return "luminance_cosine";
    case Kind::rgb:
      return "rgb";
    case Kind::rgb_cosine:
      return "rgb_cosine";
  }
  return "";
}

Model empty_model(const Btf& btf, const std::string& codec, Kind kind, std::size_t lobes,
                  Storage storage, const std::string& parameters) {
  Model model{.codec = codec, .head = fitted_head(btf, parameters)};
  model.storage = storage;
  model.kind = kind;
  model.lobes = lobes;
  model.fields.resize(model.head.views.size() * model.head.texels() * model.floats_a_field());
  return model;
}

namespace {

std::string place_of(const Model& model, std::size_t field) {
  const std::size_t texel = field % model.head.texels();
  const auto width = static_cast<std::size_t>(model.head.width);
  return fmt::format("view {}, texel ({}, {})", field / model.head.texels(), texel % width,
                     texel / width);
}

}  // namespace

void store_fields(Model& model) {
  const std::size_t stride = model.floats_a_field();
  const std::size_t first = is_rgb(model.kind) ? 0 : stride - 4;
  float largest = 0;
  for (std::size_t i = 0; i < model.fields.size(); ++i) {
    if (!std::isfinite(model.fields[i])) throw beyond_float(place_of(model, i / stride));
    if (i % stride >= first) largest = std::max(largest, std::abs(model.fields[i]));
  }
  model.scale = colour_scale(largest);  // times four lobes of 1.2, 8,192 is still a half
  for (std::size_t i = 0; i < model.fields.size(); ++i) {
    const float by = i % stride >= first ? model.scale : 1;
    model.fields[i] = stored_value(model.storage, model.fields[i] / by);
  }
}

}  // namespace weft::reflectance_fields
