// The parameters of an SRBF fit: their names, defaults and ranges.

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "btf/error.h"
#include "codecs/srbf/fit.h"

namespace weft::srbf {

namespace {

Modes modes_parameter(const Settings& parameters) {
  const std::string name = parameters.choice("modes", mode_names());
  const std::int64_t count = parameters.integer("modes_a_kernel", 3, 1, most_modes);
  const bool multivariate = parameters.flag("multivariate", true);
  Modes modes = modes_named(name, static_cast<std::size_t>(count), multivariate);
  const std::size_t found = modes.angles.size();
  if (parameters.has("modes_a_kernel") && found != static_cast<std::size_t>(count)) {
    throw bad_input(
        parameters.where("modes_a_kernel"),
        fmt::format("modes_a_kernel = {}, but {} has {} a kernel", count,
                    multivariate ? fmt::format("modes = {}", name) : "multivariate = false", found),
        "only modes = optimal has as many as asked for, and multivariate = false always one");
  }
  modes.em_angles = parameters.flag("em_angles", false);
  if (modes.em_angles && !modes.free) {
    throw bad_input(parameters.where("em_angles"),
                    fmt::format("em_angles = true, but the angles of modes = {} are fixed", name),
                    "only modes = optimal has angles to move");
  }
  return modes;
}

Filtering filtering_parameter(const Settings& parameters) {
  return parameters.choice("filtering", {"values", "numbers"}) == "numbers" ? Filtering::numbers
                                                                            : Filtering::values;
}

// Numbers of texels that nothing draws together mean nothing when blended: errors of several times
// the data.
FitOptions defaults_for(Filtering filtering) {
  FitOptions options;
  options.filtering = filtering;
  if (filtering == Filtering::values) return options;
  options.mip_weight = 0.01;
  options.smooth_weight = 0.01;
  options.robust = false;
  options.sweeps = 3;
  return options;
}

void refuse_pulls_in_vain(const Settings& parameters, const FitOptions& options) {
  if (options.smooth_weight > 0 && options.sweeps == 0) {
    throw bad_input(
        parameters.where(parameters.has("smooth_weight") ? "smooth_weight" : "sweeps"),
        fmt::format("smooth_weight = {} with sweeps = 0: only sweeps pull towards neighbours",
                    options.smooth_weight),
        "set sweeps to 1 or more, or smooth_weight to 0");
  }
  if (options.robust && options.filtering == Filtering::numbers) {
    throw bad_input(parameters.where("robust"),
                    "robust = true with filtering = numbers: it lets go of neighbours across an "
                    "edge, and there blended numbers are wrong",
                    "leave robust out, or blend values");
  }
}

}  // namespace

FitOptions fit_options(const Settings& parameters) {
  FitOptions options = defaults_for(filtering_parameter(parameters));
  const auto count = [&](const char* key, std::int64_t fallback, std::int64_t least,
                         std::int64_t most) {
    return static_cast<int>(parameters.integer(key, fallback, least, most));
  };
  options.kernels = static_cast<std::size_t>(count("kernels", 20, 1, 64));
  options.modes = modes_parameter(parameters);
  options.quantity =
      parameters.choice("quantity", {"B", "f"}) == "f" ? Quantity::over_cosine : Quantity::radiance;
  options.storage = storage_parameter(parameters);
  options.iterations = count("iterations", options.iterations, 1, 10000);
  options.decrease = parameters.number("decrease", options.decrease, 0, 0.1);
  options.starts = count("starts", options.starts, 1, 100);
  options.sweeps = count("sweeps", options.sweeps, 0, 100);
  options.mip_weight = parameters.number("mip_weight", options.mip_weight, 0, 1e6);
  options.smooth_weight = parameters.number("smooth_weight", options.smooth_weight, 0, 1e6);
  options.robust = parameters.flag("robust", options.robust);
  options.restarts = parameters.flag("restarts", options.restarts);
  refuse_pulls_in_vain(parameters, options);
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return "bits = half               half | 8 | float: what the textures hold\n"
         "decrease = 0.001          a descent ends where ten iterations lower what it minimises by "
         "less, relatively; at the top level a fifth of it\n"
         "em_angles = false         true: the initial guess moves the angles, too (the paper)\n"
         "filtering = values        between texels and levels, of B; numbers: of what is fitted, "
         "by the GPU's filter, with defaults of its own below\n"
         "iterations = 100          of L-BFGS, each time that a texel is fitted; four times as "
         "many at "
         "the top level\n"
         "kernels = 20              J, 1 to 64\n"
         "mip_weight = 0            c_mip: pull towards the parent's numbers; 0.01 with "
         "filtering = numbers\n"
         "modes = optimal           optimal: angles are fitted; or fixed: half-half-half | "
         "half-difference | half-light-view | in-out\n"
         "modes_a_kernel = 3        K, 1 to 4; fixed modes have their own\n"
         "multivariate = true       false: one mode a kernel (the univariate SRBF)\n"
         "quantity = B              B, or f = B / cos(theta_light): what the kernels sum up to\n"
         "restarts = true           from a neighbour's kernels, where they fit a texel better\n"
         "robust = true             neighbours across an edge don't pull; false: the paper, and "
         "with filtering = numbers\n"
         "smooth_weight = 0         c_smooth: pull of the 5 x 5 neighbours' numbers in "
         "sweeps; 0.01 with filtering = numbers\n"
         "starts = 4                descents at the top level, each from another guess\n"
         "sweeps = 1                over a level, after the one that starts from its "
         "parents; 3 with filtering = numbers\n";
}

std::string to_json(const FitOptions& options) {
  return nlohmann::json{{"bits", name_of(options.storage)},
                        {"decrease", options.decrease},
                        {"em_angles", options.modes.em_angles},
                        {"filtering", name_of(options.filtering)},
                        {"iterations", options.iterations},
                        {"kernels", options.kernels},
                        {"mip_weight", options.mip_weight},
                        {"modes", options.modes.name},
                        {"modes_a_kernel", options.modes.angles.size()},
                        {"multivariate", options.modes.multivariate},
                        {"quantity", options.quantity == Quantity::radiance ? "B" : "f"},
                        {"restarts", options.restarts},
                        {"robust", options.robust},
                        {"smooth_weight", options.smooth_weight},
                        {"starts", options.starts},
                        {"sweeps", options.sweeps}}
      .dump();
}

}  // namespace weft::srbf
