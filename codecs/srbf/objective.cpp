#include "codecs/srbf/objective.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "codecs/srbf/lanes.h"

namespace weft::srbf {

namespace {

constexpr std::size_t lanes = wide_lanes;
constexpr std::size_t vectors = block_samples / lanes;  // of a block
constexpr std::size_t tile = 4;                         // of the normal equations

// a_k and b_k of every mode.
template <std::size_t K>
struct Turns {
  std::array<float, K> a;
  std::array<float, K> b;
  explicit Turns(std::span<const double> angles) {
    for (std::size_t k = 0; k < K; ++k) {
      a[k] = static_cast<float>(std::cos(angles[k]));
      b[k] = static_cast<float>(std::sin(angles[k]));
    }
  }
};

// psi_k of some samples and, where asked for, its derivative by the angle.
struct Variable {
  Wide psi[3];         // NOLINT
  Wide derivative[3];  // NOLINT
};

Variable variable(const Samples& samples, std::size_t first, float a, float b, bool derived) {
  Wide sum[3];  // NOLINT
  Wide square{};
  for (std::size_t c = 0; c < 3; ++c) {
    sum[c] = load<Wide>(&samples.light[c][first]) * a + load<Wide>(&samples.view[c][first]) * b;
    square += sum[c] * sum[c];
  }
  const Wide inverse = 1 / square_root(square + smallest_square);
  Variable v;
  for (std::size_t c = 0; c < 3; ++c) v.psi[c] = sum[c] * inverse;
  if (!derived) return v;
  const Wide along = load<Wide>(&samples.cosine[first]) * (a * a - b * b) * inverse * inverse;
  for (std::size_t c = 0; c < 3; ++c) {
    const Wide turned =
        load<Wide>(&samples.view[c][first]) * a - load<Wide>(&samples.light[c][first]) * b;
    v.derivative[c] = (turned - sum[c] * along) * inverse;
  }
  return v;
}

void add_lanes(float* sum, const Wide& v) {
  store(sum, load<Wide>(sum) + v);
}

double count_numbers(const Samples& samples) {
  return std::max(1.0, 3.0 * static_cast<double>(std::ranges::count_if(
                                 samples.gain, [](float gain) { return gain > 0; })));
}

std::size_t tile_index(std::size_t row, std::size_t column) {
  return (row * (row + 1) / 2 + column) * tile * tile * lanes;
}

}  // namespace

Objective::Objective(const Samples& samples, Shape shape, Ridge ridge)
    : samples_(samples),
      shape_(shape),
      ridge_(ridge),
      padded_((shape.kernels + tile - 1) / tile * tile),
      numbers_(count_numbers(samples)),
      gaussians_(samples.blocks() * padded_ * block_samples),
      shares_(padded_ * block_samples),
      normal_(tile_index(padded_ / tile, 0)),
      right_(padded_ * 3 * lanes),
      centre_sum_(padded_ * (3 * shape.modes + 1) * lanes),
      angle_sum_(shape.modes * lanes) {}

// Equation 3.4 at a block's samples.
template <std::size_t K>
void Objective::fill_gaussians(const Kernels& kernels, std::size_t block) {
  alignas(64) std::array<float, 3 * K * block_samples> psi;
  const Turns<K> turns(kernels.angles());
  for (std::size_t i = 0; i < vectors; ++i) {
    for (std::size_t k = 0; k < K; ++k) {
      const Variable v =
          variable(samples_, block * block_samples + i * lanes, turns.a[k], turns.b[k], false);
      for (std::size_t c = 0; c < 3; ++c)
        store(&psi[(3 * k + c) * block_samples + i * lanes], v.psi[c]);
    }
  }
  for (std::size_t j = 0; j < shape_.kernels; ++j) {
    std::array<float, 3 * K> p;
    double lengths = 0;
    for (std::size_t k = 0; k < K; ++k) {
      const double* centre = kernels.centre(j, k);
      for (std::size_t c = 0; c < 3; ++c) p[3 * k + c] = static_cast<float>(centre[c]);
      lengths += smooth_length(centre[0], centre[1], centre[2]);
    }
    const auto length = static_cast<float>(lengths);
    float* row = gaussians(block) + j * block_samples;
    for (std::size_t i = 0; i < vectors; ++i) {
      Wide exponent = Wide{} - length;
      for (std::size_t m = 0; m < 3 * K; ++m)
        exponent += load<Wide>(&psi[m * block_samples + i * lanes]) * p[m];
      const Wide gain = load<Wide>(&samples_.gain[block * block_samples + i * lanes]);
      store(row + i * lanes, exp_below_zero(exponent) * gain);
    }
  }
}

// G^T G, tile by tile of its lower half, and G^T B.
void Objective::add_normal_equations(std::size_t block) {
  const float* g = gaussians(block);
  for (std::size_t row = 0; row < padded_ / tile; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      std::array<std::array<Wide, tile>, tile> sum{};
      for (std::size_t i = 0; i < vectors; ++i) {
        std::array<Wide, tile> left;
        for (std::size_t a = 0; a < tile; ++a)
          left[a] = load<Wide>(g + (row * tile + a) * block_samples + i * lanes);
        for (std::size_t b = 0; b < tile; ++b) {
          const Wide right = load<Wide>(g + (column * tile + b) * block_samples + i * lanes);
          for (std::size_t a = 0; a < tile; ++a) sum[a][b] += left[a] * right;
        }
      }
      float* total = &normal_[tile_index(row, column)];
      for (std::size_t a = 0; a < tile; ++a) {
        for (std::size_t b = 0; b < tile; ++b) add_lanes(total + (a * tile + b) * lanes, sum[a][b]);
      }
    }
  }
  for (std::size_t j = 0; j < shape_.kernels; ++j) {
    std::array<Wide, 3> sum{};
    for (std::size_t i = 0; i < vectors; ++i) {
      const Wide gaussian = load<Wide>(g + j * block_samples + i * lanes);
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += gaussian *
                  load<Wide>(&channels_[c * samples_.count + block * block_samples + i * lanes]);
      }
    }
    for (std::size_t c = 0; c < 3; ++c) add_lanes(&right_[(3 * j + c) * lanes], sum[c]);
  }
}

void Objective::solve_colours(Kernels& kernels) const {
  const std::size_t n = shape_.kernels;
  Eigen::MatrixXd matrix(n, n);
  Eigen::MatrixXd right(n, 3);
  const double weight = pull_.weight.colour;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      const float* sum =
          &normal_[tile_index(i / tile, j / tile) + (i % tile * tile + j % tile) * lanes];
      matrix(i, j) = matrix(j, i) = sum_in_double(load<Wide>(sum)) / numbers_;
    }
    matrix(i, i) += ridge_.share * matrix(i, i) + ridge_.colour + weight;
    for (std::size_t c = 0; c < 3; ++c) {
      right(i, c) = sum_in_double(load<Wide>(&right_[(3 * i + c) * lanes])) / numbers_;
      if (weight > 0) right(i, c) += weight * pull_.target[shape_.unknowns() + 3 * i + c];
    }
  }
  const Eigen::MatrixXd colours = matrix.ldlt().solve(right);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t c = 0; c < 3; ++c) kernels.colours()[3 * j + c] = colours(j, c);
  }
}

std::vector<double> Objective::gaussian_squares() const {
  std::vector<double> squares(shape_.kernels);
  for (std::size_t j = 0; j < squares.size(); ++j) {
    const float* sum =
        &normal_[tile_index(j / tile, j / tile) + (j % tile * tile + j % tile) * lanes];
    squares[j] = sum_in_double(load<Wide>(sum)) / numbers_;
  }
  return squares;
}

// Errors of a block, squared; and the sums that the gradient is made of.
template <std::size_t K>
double Objective::add_errors(const Kernels& kernels, std::size_t block, bool with_gradient,
                             bool free_angles) {
  const std::size_t n = shape_.kernels;
  alignas(64) std::array<float, 3 * K * block_samples> psi;
  std::array<float, 3 * 64> colour;
  std::array<float, 3 * K * 64> centre;
  std::array<float, 64> ridge{};
  for (std::size_t m = 0; m < 3 * n; ++m) {
    colour[m] = static_cast<float>(kernels.colours()[m]);
    ridge[m / 3] += static_cast<float>(ridge_.share) * colour[m] * colour[m];
  }
  for (std::size_t m = 0; m < 3 * K * n; ++m) centre[m] = static_cast<float>(kernels.values()[m]);
  const Turns<K> turns(kernels.angles());
  const float* g = gaussians(block);
  Wide squares{};
  std::array<Wide, K> angle_sum{};
  for (std::size_t i = 0; i < vectors; ++i) {
    const std::size_t first = block * block_samples + i * lanes;
    std::array<Wide, 3> error;
    for (std::size_t c = 0; c < 3; ++c)
      error[c] = Wide{} - load<Wide>(&channels_[c * samples_.count + first]);
    for (std::size_t j = 0; j < n; ++j) {
      const Wide gaussian = load<Wide>(g + j * block_samples + i * lanes);
      for (std::size_t c = 0; c < 3; ++c) error[c] += gaussian * colour[3 * j + c];
    }
    for (std::size_t c = 0; c < 3; ++c) squares += error[c] * error[c];
    if (!with_gradient) continue;
    std::array<Wide, 3 * K> pulled{};  // sum over j of share_j p_j
    for (std::size_t j = 0; j < n; ++j) {
      const Wide gaussian = load<Wide>(g + j * block_samples + i * lanes);
      Wide share = gaussian * ridge[j];
      for (std::size_t c = 0; c < 3; ++c) share += error[c] * colour[3 * j + c];
      share *= gaussian;
      store(&shares_[j * block_samples + i * lanes], share);
      for (std::size_t m = 0; free_angles && m < 3 * K; ++m)
        pulled[m] += share * centre[3 * K * j + m];
    }
    for (std::size_t k = 0; k < K; ++k) {
      const Variable v = variable(samples_, first, turns.a[k], turns.b[k], free_angles);
      for (std::size_t c = 0; c < 3; ++c) {
        store(&psi[(3 * k + c) * block_samples + i * lanes], v.psi[c]);
        if (free_angles) angle_sum[k] += pulled[3 * k + c] * v.derivative[c];
      }
    }
  }
  if (!with_gradient) return sum_in_double(squares);
  for (std::size_t k = 0; k < K; ++k) add_lanes(&angle_sum_[k * lanes], angle_sum[k]);
  for (std::size_t j = 0; j < n; ++j) {
    std::array<Wide, 3 * K + 1> sum{};
    for (std::size_t i = 0; i < vectors; ++i) {
      const Wide share = load<Wide>(&shares_[j * block_samples + i * lanes]);
      for (std::size_t m = 0; m < 3 * K; ++m)
        sum[m] += share * load<Wide>(&psi[m * block_samples + i * lanes]);
      sum[3 * K] += share;
    }
    for (std::size_t m = 0; m <= 3 * K; ++m)
      add_lanes(&centre_sum_[(j * (3 * K + 1) + m) * lanes], sum[m]);
  }
  return sum_in_double(squares);
}

template <std::size_t K>
void Objective::write_gradient(const Kernels& kernels, std::span<double> gradient,
                               bool free_angles) const {
  const double factor = 2 / numbers_;
  for (std::size_t j = 0; j < shape_.kernels; ++j) {
    const float* sum = &centre_sum_[j * (3 * K + 1) * lanes];
    const double shares = sum_in_double(load<Wide>(sum + 3 * K * lanes));
    for (std::size_t k = 0; k < K; ++k) {
      const double* p = kernels.centre(j, k);
      const double inward = shares / smooth_length(p[0], p[1], p[2]);
      for (std::size_t c = 0; c < 3; ++c) {
        gradient[3 * (j * K + k) + c] =
            factor * (sum_in_double(load<Wide>(sum + (3 * k + c) * lanes)) - p[c] * inward);
      }
    }
  }
  for (std::size_t k = 0; k < K; ++k) {
    gradient[shape_.centres() + k] =
        free_angles ? factor * sum_in_double(load<Wide>(&angle_sum_[k * lanes])) : 0;
  }
}

// Equations 3.13 and 3.14 as one pull, and the ridges.
Objective::Value Objective::with_penalties(const Kernels& kernels, double squares,
                                           std::span<double> gradient, bool free_angles) const {
  Value value{.total = squares / numbers_, .data = squares / numbers_};
  const std::span<const double> x = kernels.values();
  const auto add = [&](std::size_t i, double weight, double target) {
    const double difference = x[i] - target;
    value.total += weight * difference * difference;
    if (i < gradient.size()) gradient[i] += 2 * weight * difference;
  };
  const std::vector<double> own = gaussian_squares();
  for (std::size_t i = 0; i < shape_.colours(); ++i)
    value.total += ridge_.share * own[i / 3] * std::pow(kernels.colours()[i], 2);
  for (std::size_t i = 0; i < shape_.centres(); ++i) add(i, ridge_.centre, 0);
  for (std::size_t i = shape_.unknowns(); i < x.size(); ++i) add(i, ridge_.colour, 0);
  const PullWeights& weight = pull_.weight;
  if (weight.centre > 0) {
    for (std::size_t i = 0; i < shape_.centres(); ++i) add(i, weight.centre, pull_.target[i]);
  }
  if (weight.angle > 0 && free_angles) {
    for (std::size_t i = shape_.centres(); i < shape_.unknowns(); ++i)
      add(i, weight.angle, pull_.target[i]);
  }
  if (weight.colour > 0) {
    for (std::size_t i = shape_.unknowns(); i < x.size(); ++i)
      add(i, weight.colour, pull_.target[i]);
  }
  return value;
}

template <std::size_t K>
Objective::Value Objective::run(Kernels& kernels, std::span<double> gradient, bool free_angles) {
  for (std::vector<float>* sum : {&normal_, &right_, &centre_sum_, &angle_sum_})
    std::ranges::fill(*sum, 0.0F);
  for (std::size_t block = 0; block < samples_.blocks(); ++block) {
    fill_gaussians<K>(kernels, block);
    add_normal_equations(block);
  }
  solve_colours(kernels);
  double squares = 0;
  for (std::size_t block = 0; block < samples_.blocks(); ++block)
    squares += add_errors<K>(kernels, block, !gradient.empty(), free_angles);
  if (!gradient.empty()) write_gradient<K>(kernels, gradient, free_angles);
  return with_penalties(kernels, squares, gradient, free_angles);
}

Objective::Value Objective::operator()(Kernels& kernels, std::span<double> gradient,
                                       bool free_angles) {
  switch (shape_.modes) {
    case 1:
      return run<1>(kernels, gradient, free_angles);
    case 2:
      return run<2>(kernels, gradient, free_angles);
    case 3:
      return run<3>(kernels, gradient, free_angles);
    default:
      return run<4>(kernels, gradient, free_angles);
  }
}

}  // namespace weft::srbf
