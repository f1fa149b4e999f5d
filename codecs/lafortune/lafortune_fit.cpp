#include "codecs/lafortune/lafortune_fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "codecs/branchless_double.h"
#include "codecs/normal_sums.h"

namespace weft::lafortune {

namespace {

using Vec = DoubleLanes;

constexpr std::size_t lanes = PairTable::lanes;

// (axis . m)^n at eight pairs, 0 where the product is not positive.
struct LobeLanes {
  Vec power;
  Vec log_product;
  Vec product;
};

constexpr double least_product = 1e-6;

LobeLanes lobe_lanes(const PairTable& pairs, std::size_t i, const Lobe& lobe) {
  const Vec product = load_lanes(pairs.x() + i) * lobe.axis[0] +
                      load_lanes(pairs.y() + i) * lobe.axis[1] +
                      load_lanes(pairs.z() + i) * lobe.axis[2];
  const Vec held = product > least_product ? product : Vec{} + 1;
  const Vec log_product = log_lanes(held);
  const Vec power = exp_lanes(log_product * lobe.exponent);
  return {product > least_product ? power : Vec{}, log_product, held};
}

Vec value_lanes(const PairTable& pairs, std::size_t i, const Lafortune& model) {
  Vec value = Vec{} + model.diffuse;
  for (int k = 0; k < model.count; ++k)
    value += lobe_lanes(pairs, i, model.lobe[k]).power * model.lobe[k].peak;
  return load_lanes(pairs.cosine() + i) * value;
}

}  // namespace

template <int K>
NormalEquations<parameters_a_lobe * K + 1> normal_equations(const PairTable& pairs,
                                                            std::span<const double> values,
                                                            const Lafortune& model) {
  constexpr int n = parameters_a_lobe * K + 1;
  NormalSums<n> sums;
  for (std::size_t i = 0; i < pairs.padded(); i += lanes) {
    const Vec cosine = load_lanes(pairs.cosine() + i);
    Vec residual = load_lanes(&values[i]) - cosine * model.diffuse;
    std::array<Vec, n> row;
    row[n - 1] = cosine;
    for (int k = 0; k < K; ++k) {
      const Lobe& lobe = model.lobe[k];
      const LobeLanes lane = lobe_lanes(pairs, i, lobe);
      const Vec height = cosine * lane.power * lobe.peak;
      const Vec slope = height * lobe.exponent;
      const Vec turn = slope / lane.product;
      row[parameters_a_lobe * k] = turn * load_lanes(pairs.x() + i);
      row[parameters_a_lobe * k + 1] = turn * load_lanes(pairs.y() + i);
      row[parameters_a_lobe * k + 2] = turn * load_lanes(pairs.z() + i);
      row[parameters_a_lobe * k + 3] = slope * lane.log_product;
      residual -= height;
    }
    sums.add(row, residual);
  }
  return sums.sums();
}

namespace {

template <int K>
std::array<bool, parameters_a_lobe * K + 1> free_parameters(
    const NormalEquations<parameters_a_lobe * K + 1>& normal, const Lafortune& model) {
  constexpr int diffuse = parameters_a_lobe * K;
  std::array<bool, parameters_a_lobe * K + 1> free;
  free.fill(true);
  for (int k = 0; k < K; ++k) {
    const double narrower = normal.right[parameters_a_lobe * k + 3];
    const double exponent = model.lobe[k].exponent;
    if ((exponent <= least_exponent && narrower <= 0) ||
        (exponent >= largest_exponent && narrower >= 0))
      free[parameters_a_lobe * k + 3] = false;
  }
  if ((model.diffuse <= 0 && normal.right[diffuse] <= 0) ||
      (model.diffuse >= largest_peak && normal.right[diffuse] >= 0))
    free[diffuse] = false;
  return free;
}

// A longer axis is a higher peak.
void move_lobe(Lobe& lobe, const double* step) {
  const double length = std::max({std::abs(step[0]), std::abs(step[1]), std::abs(step[2])});
  const double longest = std::min(0.3, 1.5 / lobe.exponent);  // else e^1.5 times as high
  const double by = length > longest ? longest / length : 1;
  double largest = 0;
  for (int c = 0; c < 3; ++c) {
    lobe.axis[c] += by * step[c];
    largest = std::max(largest, std::abs(lobe.axis[c]));
  }
  for (double& a : lobe.axis) a /= largest;
  constexpr double least_peak = 1e-9;  // a lobe of none would stay so
  lobe.peak = std::clamp(lobe.peak * std::pow(largest, lobe.exponent), least_peak, largest_peak);
  lobe.exponent = std::clamp(lobe.exponent * std::exp(std::clamp(step[3], -1.0, 1.0)),
                             least_exponent, largest_exponent);
}

}  // namespace

template <int K>
Lafortune stepped(const Lafortune& model,
                  const std::array<double, parameters_a_lobe * K + 1>& step) {
  Lafortune next = model;
  for (int k = 0; k < K; ++k) move_lobe(next.lobe[k], &step[parameters_a_lobe * k]);
  next.diffuse = std::clamp(model.diffuse + step[parameters_a_lobe * K], 0.0, largest_peak);
  return next;
}

template NormalEquations<parameters_a_lobe + 1> normal_equations<1>(const PairTable&,
                                                                    std::span<const double>,
                                                                    const Lafortune&);
template NormalEquations<parameters_a_lobe * 2 + 1> normal_equations<2>(const PairTable&,
                                                                        std::span<const double>,
                                                                        const Lafortune&);
template NormalEquations<parameters_a_lobe * 3 + 1> normal_equations<3>(const PairTable&,
                                                                        std::span<const double>,
                                                                        const Lafortune&);
template Lafortune stepped<1>(const Lafortune&, const std::array<double, parameters_a_lobe + 1>&);
template Lafortune stepped<2>(const Lafortune&,
                              const std::array<double, parameters_a_lobe * 2 + 1>&);
template Lafortune stepped<3>(const Lafortune&,
                              const std::array<double, parameters_a_lobe * 3 + 1>&);

namespace {

template <int K>
double improve_model(const PairTable& pairs, std::span<const double> values,
                     const FitLimits& limits, Lafortune& model) {
  return levenberg_marquardt<parameters_a_lobe * K + 1>(
      limits, model, [&](const Lafortune& at) { return normal_equations<K>(pairs, values, at); },
      free_parameters<K>, stepped<K>);
}

struct Shape {
  std::array<double, 3> axis;
  double exponent;
};

constexpr Shape mirror{{-1, -1, 1}, 30};
constexpr Shape broad_mirror{{-1, -1, 1}, 4};
constexpr Shape retro{{1, 1, 1}, 8};
constexpr Shape upright{{0, 0, 1}, 2};
constexpr Shape grazing{{-1, -1, 0.5}, 6};

// The first `count` of each are a start.
constexpr std::array<std::array<Shape, most_lobes>, 4> shapes{{{mirror, upright, retro},
                                                               {broad_mirror, retro, mirror},
                                                               {mirror, broad_mirror, upright},
                                                               {upright, grazing, mirror}}};

}  // namespace

PairTable::PairTable(const HemisphereSampling& views, const HemisphereSampling& lights) {
  for (std::size_t view = 0; view < views.size(); ++view) {
    for (std::size_t light = 0; light < lights.size(); ++light) {
      if (!(lights[light].z > 0) || !(views[view].z > 0)) continue;
      pair_.push_back(view * lights.size() + light);
      for (int c = 0; c < 3; ++c)
        m_[c].push_back(static_cast<double>(lights[light][c]) * views[view][c]);
      cosine_.push_back(lights[light].z);
    }
  }
  const std::size_t padded = (size() + lanes - 1) / lanes * lanes;
  for (auto& m : m_) m.resize(padded);
  cosine_.resize(padded);
}

void evaluate(const PairTable& pairs, const Lafortune& model, std::span<double> values) {
  for (std::size_t i = 0; i < pairs.padded(); i += lanes) {
    const Vec value = value_lanes(pairs, i, model);
    std::memcpy(&values[i], &value, sizeof value);
  }
}

double squared_error(const PairTable& pairs, std::span<const double> values,
                     const Lafortune& model) {
  Vec error{};
  for (std::size_t i = 0; i < pairs.padded(); i += lanes) {
    const Vec residual = load_lanes(&values[i]) - value_lanes(pairs, i, model);
    error += residual * residual;
  }
  return sum_of(error);
}

void fit_heights(const PairTable& pairs, std::span<const double> values, Lafortune& model) {
  constexpr std::size_t most = most_lobes + 1;
  const auto count = static_cast<std::size_t>(model.count) + 1;
  std::array<std::array<double, most>, most> matrix{};
  std::array<double, most> right{};
  for (std::size_t i = 0; i < pairs.padded(); i += lanes) {
    std::array<Vec, most> part;
    const Vec cosine = load_lanes(pairs.cosine() + i);
    for (std::size_t k = 0; k < count; ++k) {
      part[k] = k + 1 == count ? cosine : cosine * lobe_lanes(pairs, i, model.lobe[k]).power;
      right[k] += sum_of(part[k] * load_lanes(&values[i]));
      for (std::size_t j = 0; j <= k; ++j) {
        matrix[k][j] += sum_of(part[k] * part[j]);
        matrix[j][k] = matrix[k][j];
      }
    }
  }
  // Within bounds, one after the other, until they stay (Gauss-Seidel, projected).
  std::array<double, most> height{};
  for (int round = 0; round < 50; ++round) {
    for (std::size_t k = 0; k < count; ++k) {
      double sum = right[k];
      for (std::size_t j = 0; j < count; ++j) sum -= j == k ? 0 : matrix[k][j] * height[j];
      // Else no pair is near the lobe, or a value is no number.
      const bool is_told = matrix[k][k] > 1e-12 && std::isfinite(sum);
      height[k] = is_told ? std::clamp(sum / matrix[k][k], 0.0, largest_peak) : 0;
    }
  }
  for (int k = 0; k < model.count; ++k) model.lobe[k].peak = height[k];
  model.diffuse = height[count - 1];
}

double improve(const PairTable& pairs, std::span<const double> values, const FitLimits& limits,
               Lafortune& model) {
  switch (model.count) {
    case 1:
      return improve_model<1>(pairs, values, limits, model);
    case 2:
      return improve_model<2>(pairs, values, limits, model);
    default:
      return improve_model<3>(pairs, values, limits, model);
  }
}

TexelFit fit_texel(const PairTable& pairs, std::span<const double> values, int count) {
  // Few steps from each start, then on from the best.
  constexpr FitLimits first{.iterations = 12, .tolerance = 1e-3};
  constexpr FitLimits last{.iterations = 60, .tolerance = 1e-6};
  TexelFit best;
  best.model.count = count;
  fit_heights(pairs, values, best.model);
  best.error = squared_error(pairs, values, best.model);
  best.fell_back = true;
  for (const auto& shape : shapes) {
    Lafortune model;
    model.count = count;
    for (int k = 0; k < count; ++k) model.lobe[k] = {shape[k].axis, 0, shape[k].exponent};
    fit_heights(pairs, values, model);
    for (int k = 0; k < count; ++k) model.lobe[k].peak = std::max(model.lobe[k].peak, 1e-3);
    const double error = improve(pairs, values, first, model);
    if (!(error <= best.error) || std::isinf(error)) continue;  // a NaN is no fit
    best = {model, error, false};
  }
  if (!best.fell_back) best.error = improve(pairs, values, last, best.model);
  return best;
}

}  // namespace weft::lafortune
