// A hemisphere sampling as JSON: angles for people, exact vectors and triangles for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "btf/hemisphere_sampling.h"

namespace weft {

/// {"theta_phi": [[degrees, degrees], …], "vectors": [[x, y, z], …], "triangles": [[i, j, k], …],
/// "horizon": "hold"}
nlohmann::ordered_json sampling_to_json(const HemisphereSampling& sampling);

/// @param where  file and field, for messages. @throws Error  naming what is missing or wrong.
HemisphereSampling sampling_from_json(const nlohmann::ordered_json& json, const std::string& where);

}  // namespace weft
