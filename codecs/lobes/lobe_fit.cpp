#include "codecs/lobes/lobe_fit.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "codecs/branchless_double.h"
#include "codecs/normal_sums.h"

namespace weft::lobes {

namespace {

using Vec = DoubleLanes;

constexpr std::size_t lanes = LightTable::lanes;

using Vec3d = std::array<double, 3>;

Vec3d normalised(const Vec3d& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

// Two vectors that are a frame with d (Duff et al., JCGT 2017).
std::array<Vec3d, 2> tangents(const Vec3d& d) {
  const double sign = std::copysign(1.0, d[2]);
  const double a = -1 / (sign + d[2]);
  const double b = d[0] * d[1] * a;
  return {
      {{1 + sign * d[0] * d[0] * a, sign * b, -sign * d[0]}, {b, sign + d[1] * d[1] * a, -d[1]}}};
}

// cos^n and what its derivatives need, at eight lights.
struct LobeLanes {
  Vec power;       // 0 where the light is behind
  Vec log_cosine;  // of a cosine that is at least `least_cosine`
  Vec cosine;
};

// Keeps log and 1 / cos finite; a light nearer to the lobe's edge counts as behind.
constexpr double least_cosine = 1e-6;

Vec dot(const LightTable& lights, std::size_t i, const Vec3d& d) {
  return load_lanes(lights.x() + i) * d[0] + load_lanes(lights.y() + i) * d[1] +
         load_lanes(lights.z() + i) * d[2];
}

LobeLanes lobe_lanes(const LightTable& lights, std::size_t i, const Lobe& lobe) {
  const Vec cosine = dot(lights, i, lobe.axis);
  const Vec held = cosine > least_cosine ? cosine : Vec{} + 1;
  const Vec log_cosine = log_lanes(held);
  const Vec power = exp_lanes(log_cosine * lobe.exponent);
  return {cosine > least_cosine ? power : Vec{}, log_cosine, held};
}

}  // namespace

template <int K>
NormalEquations<parameters_a_lobe * K> normal_equations(const LightTable& lights,
                                                        std::span<const double> values,
                                                        const LobeSum& lobes) {
  constexpr int n = parameters_a_lobe * K;
  NormalSums<n> sums;
  std::array<std::array<Vec3d, 2>, K> frame;
  for (int k = 0; k < K; ++k) frame[k] = tangents(lobes.lobe[k].axis);
  for (std::size_t i = 0; i < lights.padded(); i += lanes) {
    Vec residual = load_lanes(&values[i]);
    std::array<Vec, n> row;
    for (int k = 0; k < K; ++k) {
      const Lobe& lobe = lobes.lobe[k];
      const LobeLanes lane = lobe_lanes(lights, i, lobe);
      const Vec slope = lane.power * (lobe.peak * lobe.exponent);
      const Vec turn = slope / lane.cosine;
      row[parameters_a_lobe * k] = turn * dot(lights, i, frame[k][0]);
      row[parameters_a_lobe * k + 1] = turn * dot(lights, i, frame[k][1]);
      row[parameters_a_lobe * k + 2] = lane.power;
      row[parameters_a_lobe * k + 3] = slope * lane.log_cosine;
      residual -= lane.power * lobe.peak;
    }
    sums.add(row, residual);
  }
  return sums.sums();
}

namespace {

// A parameter at its bound that the gradient pushes beyond.
template <int K>
std::array<bool, parameters_a_lobe * K> free_parameters(
    const NormalEquations<parameters_a_lobe * K>& normal, const LobeSum& lobes) {
  std::array<bool, parameters_a_lobe * K> free;
  free.fill(true);
  for (int k = 0; k < K; ++k) {
    const Lobe& lobe = lobes.lobe[k];
    const double up = normal.right[parameters_a_lobe * k + 2];
    const double wider = normal.right[parameters_a_lobe * k + 3];
    if ((lobe.peak <= 0 && up <= 0) || (lobe.peak >= largest_peak && up >= 0))
      free[parameters_a_lobe * k + 2] = false;
    if ((lobe.exponent <= least_exponent && wider <= 0) ||
        (lobe.exponent >= largest_exponent && wider >= 0))
      free[parameters_a_lobe * k + 3] = false;
  }
  return free;
}

// A step of an axis or an exponent that leaves what the derivatives say anything about is cut.
constexpr double longest_turn = 0.5;      // radians
constexpr double largest_log_step = 1.0;  // of the exponent

}  // namespace

template <int K>
LobeSum stepped(const LobeSum& lobes, const std::array<double, parameters_a_lobe * K>& step) {
  LobeSum next = lobes;
  for (int k = 0; k < K; ++k) {
    Lobe& lobe = next.lobe[k];
    const double* s = &step[parameters_a_lobe * k];
    const auto frame = tangents(lobe.axis);
    const double turn = std::hypot(s[0], s[1]);
    const double scale = turn > longest_turn ? longest_turn / turn : 1;
    Vec3d axis;
    for (int c = 0; c < 3; ++c)
      axis[c] = lobe.axis[c] + scale * (s[0] * frame[0][c] + s[1] * frame[1][c]);
    lobe.axis = normalised(axis);
    lobe.peak = std::clamp(lobe.peak + s[2], 0.0, largest_peak);
    lobe.exponent =
        std::clamp(lobe.exponent * std::exp(std::clamp(s[3], -largest_log_step, largest_log_step)),
                   least_exponent, largest_exponent);
  }
  return next;
}

template NormalEquations<parameters_a_lobe> normal_equations<1>(const LightTable&,
                                                                std::span<const double>,
                                                                const LobeSum&);
template NormalEquations<parameters_a_lobe * 2> normal_equations<2>(const LightTable&,
                                                                    std::span<const double>,
                                                                    const LobeSum&);
template NormalEquations<parameters_a_lobe * 3> normal_equations<3>(const LightTable&,
                                                                    std::span<const double>,
                                                                    const LobeSum&);
template NormalEquations<parameters_a_lobe * 4> normal_equations<4>(const LightTable&,
                                                                    std::span<const double>,
                                                                    const LobeSum&);
template LobeSum stepped<1>(const LobeSum&, const std::array<double, parameters_a_lobe>&);
template LobeSum stepped<2>(const LobeSum&, const std::array<double, parameters_a_lobe * 2>&);
template LobeSum stepped<3>(const LobeSum&, const std::array<double, parameters_a_lobe * 3>&);
template LobeSum stepped<4>(const LobeSum&, const std::array<double, parameters_a_lobe * 4>&);

namespace {

template <int K>
double improve_sum(const LightTable& lights, std::span<const double> values,
                   const FitLimits& limits, LobeSum& lobes) {
  return levenberg_marquardt<parameters_a_lobe * K>(
      limits, lobes, [&](const LobeSum& at) { return normal_equations<K>(lights, values, at); },
      free_parameters<K>, stepped<K>);
}

}  // namespace

LightTable::LightTable(const HemisphereSampling& lights) {
  std::vector<std::size_t> place(lights.size(), lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (!(lights[i].z > 0)) continue;
    place[i] = index_.size();
    index_.push_back(i);
  }
  const std::size_t padded = (index_.size() + lanes - 1) / lanes * lanes;
  for (auto [values, axis] : {std::pair(&x_, 0), {&y_, 1}, {&z_, 2}}) {
    values->resize(padded);
    for (std::size_t i = 0; i < index_.size(); ++i) (*values)[i] = lights[index_[i]][axis];
  }
  std::vector<std::set<std::size_t>> joined(index_.size());
  for (const auto& triangle : lights.triangles()) {
    for (const auto a : triangle) {
      for (const auto b : triangle) {
        // Those of the ring below the horizon are no lights.
        if (a == b || a >= lights.size() || b >= lights.size()) continue;
        if (place[a] < index_.size() && place[b] < index_.size()) joined[place[a]].insert(place[b]);
      }
    }
  }
  for (const auto& set : joined) neighbours_.emplace_back(set.begin(), set.end());
}

void evaluate(const LightTable& lights, const LobeSum& lobes, std::span<double> values) {
  for (std::size_t i = 0; i < lights.padded(); i += lanes) {
    Vec sum{};
    for (int k = 0; k < lobes.count; ++k)
      sum += lobe_lanes(lights, i, lobes.lobe[k]).power * lobes.lobe[k].peak;
    std::memcpy(&values[i], &sum, sizeof sum);
  }
}

double squared_error(const LightTable& lights, std::span<const double> values,
                     const LobeSum& lobes) {
  Vec error{};
  for (std::size_t i = 0; i < lights.padded(); i += lanes) {
    Vec residual = load_lanes(&values[i]);
    for (int k = 0; k < lobes.count; ++k)
      residual -= lobe_lanes(lights, i, lobes.lobe[k]).power * lobes.lobe[k].peak;
    error += residual * residual;
  }
  return sum_of(error);
}

double improve(const LightTable& lights, std::span<const double> values, const FitLimits& limits,
               LobeSum& lobes) {
  switch (lobes.count) {
    case 1:
      return improve_sum<1>(lights, values, limits, lobes);
    case 2:
      return improve_sum<2>(lights, values, limits, lobes);
    case 3:
      return improve_sum<3>(lights, values, limits, lobes);
    default:
      return improve_sum<4>(lights, values, limits, lobes);
  }
}

void fit_peaks(const LightTable& lights, std::span<const double> values, LobeSum& lobes) {
  std::array<std::array<double, most_lobes>, most_lobes> matrix{};
  std::array<double, most_lobes> right{};
  for (std::size_t i = 0; i < lights.padded(); i += lanes) {
    std::array<Vec, most_lobes> power;
    for (int k = 0; k < lobes.count; ++k) {
      power[k] = lobe_lanes(lights, i, lobes.lobe[k]).power;
      right[k] += sum_of(power[k] * load_lanes(&values[i]));
      for (int j = 0; j <= k; ++j) {
        matrix[k][j] += sum_of(power[k] * power[j]);
        matrix[j][k] = matrix[k][j];
      }
    }
  }
  // A few numbers within bounds: one after the other, until they stay (Gauss-Seidel, projected).
  constexpr int rounds = 30;
  for (int round = 0; round < rounds; ++round) {
    for (int k = 0; k < lobes.count; ++k) {
      double sum = right[k];
      for (int j = 0; j < lobes.count; ++j) {
        if (j != k) sum -= matrix[k][j] * lobes.lobe[j].peak;
      }
      // Else no light is near its axis, or a value is no number.
      const bool is_told = matrix[k][k] > 1e-12 && std::isfinite(sum);
      lobes.lobe[k].peak = is_told ? std::clamp(sum / matrix[k][k], 0.0, largest_peak) : 0;
    }
  }
}

}  // namespace weft::lobes
