// Materials as a person writes them.
#include <algorithm>

#include "btf/error.h"
#include "tracer/bsdf.h"

namespace weft {

Bsdf read_bsdf(const Settings& settings) {
  const std::string type = settings.choice("type", {"lambert", "conductor", "plastic"});
  const auto unit_colour = [&](const std::string& key, const Rgb& fallback) {
    const Rgb colour = settings.rgb(key, fallback);
    if (max_component(colour) > 1) {
      throw bad_input(settings.where(key), key + " is above 1; expected 0 to 1");
    }
    return colour;
  };
  const auto alpha = [&](double fallback) {
    return static_cast<float>(settings.number("alpha", fallback, 1e-4, 1));
  };
  if (type == "lambert") return Bsdf::lambert(unit_colour("albedo", Rgb(0.5F)));
  if (type == "plastic") {
    const auto ior = static_cast<float>(settings.number("ior", 1.5, 1.0001, 4));
    return Bsdf::plastic(unit_colour("albedo", Rgb(0.5F)), ior, alpha(0.2));
  }
  for (const std::string key : {"eta", "k"}) {
    if (!settings.has("f0") || !settings.has(key)) continue;
    throw bad_input(settings.where(key),
                    "a conductor has either f0 or eta and k, and here it has f0 and " + key,
                    "f0 may be the mesostructure's own: give type = 'conductor' too, and no "
                    "default is taken");
  }
  if (settings.has("f0")) return Bsdf::conductor_f0(unit_colour("f0", Rgb(1)), alpha(0.2));
  // Gold, of Johnson and Christy 1972, at 630, 532 and 465 nm.
  const Rgb eta = settings.rgb("eta", Rgb(0.18F, 0.55F, 1.34F));
  const Rgb k = settings.rgb("k", Rgb(3.4F, 2.2F, 1.88F));
  if (std::min({eta.x, eta.y, eta.z}) <= 0) {
    throw bad_input(settings.where("eta"), "eta must be above 0");
  }
  return Bsdf::conductor(eta, k, alpha(0.2));
}

}  // namespace weft
