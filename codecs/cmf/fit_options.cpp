// The parameters of a CMF fit: their names, defaults and ranges.

#include <nlohmann/json.hpp>

#include "btf/error.h"
#include "codecs/cmf/fit.h"

namespace weft::cmf {

namespace {

constexpr const char* four_factors = "light,half,difference,view";
constexpr const char* three_factors = "light,half,view";
constexpr const char* two_factors = "light,view";

constexpr int refine_codebooks = 3;

}  // namespace

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  ChainOptions& chain = options.chain;
  const std::string factors =
      parameters.choice("factors", {three_factors, two_factors, four_factors});
  chain.half = factors != two_factors;
  chain.difference = factors == four_factors;
  for (const char* key : {"difference_rings", "refine", "order"}) {
    if (!chain.half && parameters.has(key)) {
      throw bad_input(
          parameters.where(key),
          std::string(key) + " is of the half factor, which factors=light,view leaves out",
          "leave it out too");
    }
  }
  options.storage = factor_maps::storage_options(parameters, refine_codebooks);
  chain.resolution = options.storage.resolution;
  chain.sign = options.storage.eight_bit ? Sign::non_negative : Sign::any;
  chain.terms =
      static_cast<int>(parameters.integer("terms", chain.terms, 1, factor_maps::max_terms));
  if (chain.terms > 1) {
    if (parameters.has("refine_codebooks") && options.storage.refine_codebooks > 0) {
      throw bad_input(parameters.where("refine_codebooks"),
                      "refine_codebooks is of products of one term", "leave it or terms out");
    }
    options.storage.refine_codebooks = 0;
  }
  chain.order = parameters.choice("order", {"half-first", "half-last"}) == "half-last"
                    ? Order::half_last
                    : Order::half_first;
  chain.difference_rings =
      static_cast<int>(parameters.integer("difference_rings", chain.difference_rings, 1, 64));
  chain.rank_one = parameters.choice("rank_one", {"weighted", "plain"}) == "plain"
                       ? RankOne::plain
                       : RankOne::weighted;
  chain.refine = static_cast<int>(parameters.integer("refine", chain.refine, 0, 100000));
  // What decodes fast when turned; and only what shares maps gains by it.
  options.rotate = parameters.flag(
      "rotate", options.storage.clustered && chain.half && !chain.difference && chain.terms == 1);
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return factor_maps::storage_help(refine_codebooks) +
         "difference_rings = 8      grid that the half factor averages over: N x 2 N differences\n"
         "factors = light,half,view also light,view and light,half,difference,view\n"
         "order = half-first        half-first | half-last: which link of the chain is fitted "
         "first\n"
         "rank_one = weighted       error that light and view make least: that of B, as it is "
         "seen; plain: of f / Q (the paper)\n"
         "refine = 2                rounds that alternate over all factors after the chain\n"
         "rotate = true             turn each ABRDF into its direction of greatest anisotropy "
         "first; false where not clustered, of several terms or other factors\n"
         "terms = 1                 products added in each link of two factors, 1 to 8; below zero "
         "too with bits = float\n";
}

std::string to_json(const FitOptions& options) {
  const ChainOptions& chain = options.chain;
  nlohmann::json json{{"difference_rings", chain.difference_rings},
                      {"factors", chain.difference ? four_factors
                                  : chain.half     ? three_factors
                                                   : two_factors},
                      {"order", chain.order == Order::half_last ? "half-last" : "half-first"},
                      {"rank_one", chain.rank_one == RankOne::plain ? "plain" : "weighted"},
                      {"refine", chain.refine},
                      {"rotate", options.rotate},
                      {"terms", chain.terms}};
  factor_maps::add_to(json, options.storage);
  return json.dump();
}

}  // namespace weft::cmf
