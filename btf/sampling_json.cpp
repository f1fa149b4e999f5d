#include "btf/sampling_json.h"

#include <nlohmann/json.hpp>

#include "btf/error.h"

namespace weft {

using Json = nlohmann::ordered_json;

Json sampling_to_json(const HemisphereSampling& sampling) {
  Json angles = Json::array();
  Json vectors = Json::array();
  for (const Direction& d : sampling.directions()) {
    angles.push_back({degrees(theta_of(d)), degrees(phi_of(d))});
    vectors.push_back({d.x, d.y, d.z});
  }
  Json triangles = Json::array();
  for (const auto& t : sampling.triangles()) triangles.push_back(t);
  return {{"theta_phi", angles},
          {"vectors", vectors},
          {"triangles", triangles},
          {"horizon", sampling.horizon() == Horizon::hold ? "hold" : "fade"}};
}

HemisphereSampling sampling_from_json(const Json& json, const std::string& where) {
  try {
    std::vector<Direction> directions;
    for (const auto& v : json.at("vectors")) {
      directions.emplace_back(v.at(0).get<float>(), v.at(1).get<float>(), v.at(2).get<float>());
    }
    const auto triangles = json.at("triangles").get<std::vector<std::array<std::uint16_t, 3>>>();
    const auto horizon = json.at("horizon").get<std::string>();
    if (horizon != "hold" && horizon != "fade") {
      throw bad_input(where + ".horizon", "is \"" + horizon + "\"; expected hold or fade");
    }
    return {std::move(directions), triangles, horizon == "hold" ? Horizon::hold : Horizon::fade};
  } catch (const Json::exception& error) {
    throw bad_input(where, std::string("cannot be understood: ") + error.what());
  }
}

}  // namespace weft
