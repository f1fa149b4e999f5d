// The parameters of a Laplacian fit: their names, defaults and ranges.

#include <nlohmann/json.hpp>

#include "codecs/laplacian/fit.h"

namespace weft::laplacian {

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  const auto count = [&](const char* key, std::size_t fallback) {
    return static_cast<std::size_t>(
        parameters.integer(key, static_cast<std::int64_t>(fallback), 1, 32));
  };
  options.components = {count("components_y", 8), count("components_cb", 2),
                        count("components_cr", 2)};
  const std::string filters = parameters.choice("filters", {"box3", "box2", "linear"});
  for (const Filters f : {Filters::box3, Filters::box2, Filters::linear}) {
    if (name_of(f) == filters) options.filters = f;
  }
  options.top = static_cast<int>(parameters.integer("levels", 0, 0, 15)) - 1;
  options.around =
      parameters.choice("top", {"model", "mean"}) == "mean" ? TopAround::mean : TopAround::model;
  options.chroma = parameters.choice("chroma_mean", {"constant", "cosine"}) == "cosine"
                       ? ChromaMean::cosine
                       : ChromaMean::constant;
  options.closed_loop = parameters.choice("prediction", {"closed", "open"}) == "closed";
  options.interpolated = parameters.choice("directions", {"nearest", "interpolated"}) != "nearest";
  const std::string bits = parameters.choice("bits", {"float", "half", "8"});
  options.storage = bits == "float"  ? Storage::float32
                    : bits == "half" ? Storage::half
                                     : Storage::eight_bit;
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return "bits = float              float (the paper) | half | 8: what the textures hold\n"
         "chroma_mean = constant    the top's mean Cb and Cr; cosine: times cos(theta_light)\n"
         "components_cb = 2         eigen Laplacian BRDFs of each level, 1 to 32\n"
         "components_cr = 2         likewise\n"
         "components_y = 8          likewise\n"
         "directions = nearest      nearest (the paper) | interpolated\n"
         "filters = box3            box3: 3 x 3 box and nearest (the paper); box2: 2 x 2; linear: "
         "(1, 3, 3, 1) / 8 and bilinear\n"
         "levels = 0                of the pyramid; 0: until two texels a component are left\n"
         "prediction = closed       closed: levels mend what coarser ones lost; open: the paper\n"
         "top = model               its components are taken around the mean's model; mean: around "
         "the mean (the paper)\n";
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{
      {"bits", name_of(options.storage)},
      {"chroma_mean", options.chroma == ChromaMean::cosine ? "cosine" : "constant"},
      {"components_cb", options.components[1]},
      {"components_cr", options.components[2]},
      {"components_y", options.components[0]},
      {"directions", options.interpolated ? "interpolated" : "nearest"},
      {"filters", name_of(options.filters)},
      {"levels", options.top + 1},
      {"prediction", options.closed_loop ? "closed" : "open"},
      {"top", options.around == TopAround::mean ? "mean" : "model"}}
      .dump();
}

}  // namespace weft::laplacian
