#include "codecs/srbf/modes.h"

#include <algorithm>
#include <numbers>

namespace weft::srbf {

namespace {

constexpr double light = 0;
constexpr double half = std::numbers::pi / 4;
constexpr double view = std::numbers::pi / 2;
constexpr double difference = -std::numbers::pi / 4;

std::vector<Modes> known_modes() {
  return {{"optimal", {half, light, view, difference}, true},
          {"half-half-half", {half, half, half}},
          {"half-difference", {half, difference}},
          {"half-light-view", {half, light, view}},
          {"in-out", {light, view}}};
}

}  // namespace

Modes modes_named(const std::string& name, std::size_t count, bool multivariate) {
  const std::vector<Modes> known = known_modes();
  Modes modes = *std::ranges::find(known, name, &Modes::name);
  if (modes.free) modes.angles.resize(count);
  if (!multivariate) modes.angles.resize(1);
  modes.multivariate = multivariate;
  return modes;
}

std::vector<std::string> mode_names() {
  std::vector<std::string> names;
  for (const Modes& modes : known_modes()) names.push_back(modes.name);
  return names;
}

}  // namespace weft::srbf
