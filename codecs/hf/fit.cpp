#include "codecs/hf/fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "btf/error.h"
#include "codecs/factor_maps/sample_map.h"
#include "codecs/hf/cross_validation.h"
#include "codecs/hf/log_system.h"

namespace weft::hf {

using factor_maps::BilinearTaps;
using factor_maps::FittedFactors;
using factor_maps::lane_count;
using factor_maps::Lanes;
using factor_maps::ParabolicMap;
using factor_maps::Projection;
using factor_maps::SampleMap;
using factor_maps::texels_a_block;
using factor_maps::TexelSource;

FitOptions fit_options(const Settings& parameters) {
  FitOptions options;
  options.storage = factor_maps::storage_options(parameters);
  try {
    options.lambda = parameters.number("lambda", *options.lambda, 1e-4, 1e4);
  } catch (const Error&) {
    if (parameters.choice("lambda", {"auto", "a number from 1e-4 to 1e4"}) != "auto") throw;
    options.lambda.reset();
  }
  options.floor = parameters.number("floor", options.floor, 1e-9, 1);
  parameters.finish();
  return options;
}

std::string parameter_help() {
  return factor_maps::storage_help() +
         "floor = 0.1               least value in the logarithm, as a share of the ABRDF's mean\n"
         "lambda = 1                how much the maps are smoothed, 1e-4 to 1e4; auto: by "
         "generalised cross validation\n";
}

namespace {

std::string to_json(const FitOptions& options, double lambda) {
  nlohmann::json json{{"floor", options.floor}, {"lambda", lambda}};
  if (!options.lambda) json["lambda_found_by"] = "generalised cross validation";
  factor_maps::add_to(json, options.storage);
  return json.dump();
}

Lanes largest_of(const LaneVector& values) {
  Lanes largest;
  for (const Lanes& value : values) {
    for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], value[k]);
  }
  return largest;
}

// Natural logarithms of what is raised to the floor; 0 in a lane of zeros.
DoubleVector logarithms(const LaneVector& f, double floor) {
  DoubleLanes mean;
  for (const Lanes& pair : f) {
    for (int k = 0; k < lane_count; ++k) mean[k] += pair[k];
  }
  DoubleVector result(f.size());
  for (std::size_t pair = 0; pair < f.size(); ++pair) {
    for (int k = 0; k < lane_count; ++k) {
      const double least = floor * mean[k] / static_cast<double>(f.size());
      result[pair][k] = least > 0 ? std::log(std::max<double>(f[pair][k], least)) : 0.0;
    }
  }
  return result;
}

// Of the map over the half-vector.
constexpr int half_corrections = 4;

class Solver {
 public:
  Solver(const HemisphereSampling& lights, const HemisphereSampling& views, int resolution)
      : lookup_(lights, views, ParabolicMap(resolution)),
        light_map_(lights, ParabolicMap(resolution)),
        view_map_(views, ParabolicMap(resolution)) {}

  const LogLookup& lookup() const { return lookup_; }

  /// The factors' maps, 0..1, whose product is to be multiplied by exp(shift).
  struct Solution {
    std::array<LaneVector, factor_count> maps;
    DoubleLanes shift;
  };
  Solution solve(const LogSystem& system, const DoubleVector& log_f) const {
    DoubleVector right = lookup_.transposed_times(log_f);
    const double weight = 1.0 / static_cast<double>(lookup_.pairs());
    for (DoubleLanes& value : right) {
      for (int k = 0; k < lane_count; ++k) value[k] *= weight;
    }
    return exponentials(system.solve(right));
  }
  Solution exponentials(const DoubleVector& x) const {
    Solution solution;
    for (int f = 0; f < factor_count; ++f) solution.maps[f] = exponential(x, f, solution.shift);
    return solution;
  }

 private:
  // The logarithm was filtered in the fit, the map is when it is decoded. Of a texel that few
  // samples ask for, and with a small weight, the logarithm may be large, and exp makes that a
  // power: all are cut to the largest that any sample looks up, or one would take all the steps of
  // 8 bits and swamp its neighbours. Then the map is changed so that its own lookup returns what
  // was fitted.
  LaneVector exponential(const DoubleVector& x, int factor, DoubleLanes& shift) const {
    const DoubleLanes* logarithm = &x[factor * lookup_.map_texels()];
    const std::vector<BilinearTaps>& taps = taps_of(factor);
    DoubleLanes largest;
    std::fill_n(largest.lane, lane_count, -std::numeric_limits<double>::infinity());
    for (const BilinearTaps& sample : taps) {
      const DoubleLanes value = looked_up(logarithm, sample);
      for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], value[k]);
    }
    LaneVector map(lookup_.map_texels());
    for (std::size_t t = 0; t < map.size(); ++t) {
      for (int k = 0; k < lane_count; ++k)
        map[t][k] = static_cast<float>(std::exp(std::min(logarithm[t][k] - largest[k], 0.0)));
    }
    // Looked up once more: kept for every pair, they take megabytes a thread.
    LaneVector samples(taps.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const DoubleLanes value = looked_up(logarithm, taps[i]);
      for (int k = 0; k < lane_count; ++k)
        samples[i][k] = static_cast<float>(std::exp(value[k] - largest[k]));
    }
    for (int k = 0; k < lane_count; ++k) shift[k] += largest[k];
    if (factor == 1) {
      for (int round = 0; round < half_corrections; ++round) correct(taps, samples, map);
      return map;
    }
    const SampleMap& maker = factor == 0 ? light_map_ : view_map_;
    return maker.corrected(std::move(map), samples);
  }

  const std::vector<BilinearTaps>& taps_of(int factor) const {
    return factor == 0 ? light_map_.taps() : factor == 1 ? lookup_.half() : view_map_.taps();
  }

  static DoubleLanes looked_up(const DoubleLanes* map, const BilinearTaps& taps) {
    DoubleLanes value;
    for (std::size_t t = 0; t < 4; ++t) {
      for (int k = 0; k < lane_count; ++k) value[k] += taps.weight[t] * map[taps.index[t]][k];
    }
    return value;
  }

  // One multiplicative update (Lee and Seung) of the map towards the samples, none of which is
  // above 1: half-vectors are too many for their equations to be solved.
  static void correct(const std::vector<BilinearTaps>& taps, const LaneVector& samples,
                      LaneVector& map) {
    LaneVector wanted(map.size());
    LaneVector present(map.size());
    for (std::size_t i = 0; i < taps.size(); ++i) {
      Lanes value;
      for (std::size_t t = 0; t < 4; ++t)
        factor_maps::add_scaled(value, taps[i].weight[t], map[taps[i].index[t]]);
      for (std::size_t t = 0; t < 4; ++t) {
        factor_maps::add_scaled(wanted[taps[i].index[t]], taps[i].weight[t], samples[i]);
        factor_maps::add_scaled(present[taps[i].index[t]], taps[i].weight[t], value);
      }
    }
    for (std::size_t t = 0; t < map.size(); ++t) {
      for (int k = 0; k < lane_count; ++k) {
        if (present[t][k] > 0) map[t][k] = std::min(map[t][k] * wanted[t][k] / present[t][k], 1.0F);
      }
    }
  }

  LogLookup lookup_;
  SampleMap light_map_;
  SampleMap view_map_;
};

// What is seen of the maps' error: that of B, with the best scale in each lane, over all.
double seen_error(const Solver& solver, const HemisphereSampling& lights, bool eight_bit,
                  const LaneVector& f, const DoubleVector& x) {
  std::array<LaneVector, factor_count> maps = solver.exponentials(x).maps;
  for (LaneVector& map : maps) {
    const Lanes largest = largest_of(map);
    for (Lanes& texel : map) {
      for (int k = 0; eight_bit && k < lane_count; ++k)
        texel[k] = largest[k] > 0 ? std::round(texel[k] / largest[k] * 255) : 0;
    }
  }
  const std::size_t n_views = f.size() / lights.size();
  DoubleLanes data;
  DoubleLanes product;
  DoubleLanes square;
  for (std::size_t pair = 0; pair < f.size(); ++pair) {
    std::array<Lanes, factor_count> value;
    for (int factor = 0; factor < factor_count; ++factor) {
      const factor_maps::BilinearTaps& taps = solver.lookup().taps(pair, factor);
      for (std::size_t t = 0; t < 4; ++t)
        factor_maps::add_scaled(value[factor], taps.weight[t], maps[factor][taps.index[t]]);
    }
    const double cosine = lights[pair / n_views].z;
    for (int k = 0; k < lane_count; ++k) {
      const double b = cosine * f[pair][k];
      const double g = cosine * value[0][k] * value[1][k] * value[2][k];
      data[k] += b * b;
      product[k] += b * g;
      square[k] += g * g;
    }
  }
  double error = 0;
  for (int k = 0; k < lane_count; ++k)
    error += data[k] - (square[k] > 0 ? product[k] * product[k] / square[k] : 0.0);
  return error;
}

// Sixteen texels of the finest level, evenly spread.
std::vector<std::size_t> few_texels(const TexelSource& source) {
  const auto& finest = source.levels()[0];
  const std::size_t texels = static_cast<std::size_t>(finest.width) * finest.height;
  const auto count = std::min<std::size_t>(texels_a_block, texels);
  std::vector<std::size_t> few;
  // By the golden ratio, so that neither rows nor columns repeat.
  for (std::size_t i = 0; i < count; ++i) {
    const double share = std::fmod((static_cast<double>(i) + 0.5) * 0.6180339887498949, 1.0);
    few.push_back(static_cast<std::size_t>(share * static_cast<double>(texels)));
  }
  return few;
}

double found_lambda(const TexelSource& source, const Solver& solver, int resolution,
                    const FitOptions& options) {
  const LaneVector f = source.block(few_texels(source));
  return cross_validated_lambda(
      solver.lookup(), resolution, logarithms(f, options.floor), [&](const DoubleVector& x) {
        return seen_error(solver, source.finest().lights(), options.storage.eight_bit, f, x);
      });
}

// Steep maps hardly overlap, and what their product is to be multiplied by leaves the floats. Where
// the scale is not solved again it is held at 1e18, whose square is finite too: such a fit is
// wrong, but can be saved, opened and judged.
constexpr double largest_shift = 41.4;

void store_block(Solver::Solution solution, const LaneVector& f,
                 std::span<const std::size_t> texels, FittedFactors& fitted) {
  const Lanes brightest = largest_of(f);
  for (int factor = 0; factor < factor_count; ++factor)
    store(solution.maps[factor], texels, factor, fitted);
  for (int k = 0; k < 3 * static_cast<int>(texels.size()); ++k) {
    fitted.scale[3 * texels[k / 3] + k % 3] *=
        brightest[k] > 0 ? static_cast<float>(std::exp(std::min(solution.shift[k], largest_shift)))
                         : 0.0F;
  }
}

}  // namespace

factor_maps::Model fit(const std::shared_ptr<const Btf>& btf, const FitOptions& options,
                       Progress& progress) {
  const TexelSource source(btf, options.storage.levels);
  const int resolution = options.storage.resolution;
  const Solver solver(btf->lights(), btf->views(), resolution);
  const double lambda =
      options.lambda ? *options.lambda : found_lambda(source, solver, resolution, options);
  const LogSystem system(solver.lookup(), resolution, lambda);
  FittedFactors fitted(source, options.storage);
  for (const Projection p : {Projection::light, Projection::half, Projection::view}) {
    fitted.add(p, 1);
  }
  progress.start(static_cast<std::int64_t>(source.size()), "texels");
  for (const factor_maps::Level& level : source.levels()) {
    const std::size_t count = static_cast<std::size_t>(level.width) * level.height;
    const std::size_t blocks = (count + texels_a_block - 1) / texels_a_block;
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
      std::vector<std::size_t> texels;
      for (std::size_t t = block * texels_a_block;
           t < std::min(count, (block + 1) * texels_a_block); ++t) {
        texels.push_back(level.first + t);
      }
      const LaneVector f = source.block(texels);
      store_block(solver.solve(system, logarithms(f, options.floor)), f, texels, fitted);
      progress.advance(static_cast<std::int64_t>(texels.size()));
    });
  }
  return assemble(source, std::move(fitted), options.storage, "hf", to_json(options, lambda),
                  progress);
}

}  // namespace weft::hf
