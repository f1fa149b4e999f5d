// The parameters of a CMF fit: their names, defaults and ranges.

#include <limits>
#include <nlohmann/json.hpp>

#include "btf/error.h"
#include "codecs/cmf/fit.h"

namespace weft::cmf {

namespace {

constexpr const char* three_factors = "light,half,view";
constexpr const char* two_factors = "light,view";

}  // namespace

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  ChainOptions& chain = options.chain;
  chain.half = parameters.choice("factors", {three_factors, two_factors}) == three_factors;
  for (const char* key : {"difference_rings", "refine"}) {
    if (!chain.half && parameters.has(key)) {
      throw bad_input(
          parameters.where(key),
          std::string(key) + " is of the half factor, which factors=light,view leaves out",
          "leave it out too");
    }
  }
  chain.resolution = static_cast<int>(parameters.integer("resolution", chain.resolution, 2, 256));
  chain.difference_rings =
      static_cast<int>(parameters.integer("difference_rings", chain.difference_rings, 1, 64));
  chain.rank_one = parameters.choice("rank_one", {"weighted", "plain"}) == "plain"
                       ? RankOne::plain
                       : RankOne::weighted;
  chain.refine = static_cast<int>(parameters.integer("refine", chain.refine, 0, 100000));
  options.eight_bit = parameters.choice("bits", {"8", "float"}) == "8";
  options.clustered = parameters.flag("clustered", options.clustered);
  options.clusters = static_cast<int>(parameters.integer("clusters", options.clusters, 1, 256));
  options.refit_scale = parameters.flag("refit_scale", options.refit_scale);
  options.seed = static_cast<std::uint64_t>(
      parameters.integer("seed", 0, 0, std::numeric_limits<std::int64_t>::max()));
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return "bits = 8                  8 | float: what the textures hold\n"
         "clustered = true          codebooks and index maps; false: every texel keeps its own "
         "maps\n"
         "clusters = 256            size of each factor's codebook, 1 to 256\n"
         "difference_rings = 8      grid that the half factor averages over: N x 2 N differences\n"
         "factors = light,half,view also light,view: the chain without the half factor\n"
         "rank_one = weighted       error that light and view make least: that of B, as it is "
         "seen; plain: of f / Q (the paper)\n"
         "refine = 0                rounds that alternate over all factors after the chain\n"
         "refit_scale = true        solve the scale map again after clustering and quantisation\n"
         "resolution = 32           texels a side of each parabolic map, 2 to 256\n"
         "seed = 0                  of k-means++\n";
}

std::string to_json(const FitOptions& options) {
  const nlohmann::json json{
      {"bits", options.eight_bit ? "8" : "float"},
      {"clustered", options.clustered},
      {"clusters", options.clusters},
      {"difference_rings", options.chain.difference_rings},
      {"factors", options.chain.half ? three_factors : two_factors},
      {"rank_one", options.chain.rank_one == RankOne::plain ? "plain" : "weighted"},
      {"refine", options.chain.refine},
      {"refit_scale", options.refit_scale},
      {"resolution", options.chain.resolution},
      {"seed", options.seed}};
  return json.dump();
}

}  // namespace weft::cmf
