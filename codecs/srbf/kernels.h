// The numbers of one texel: J multivariate Gaussian SRBFs of K modes with colours (paper 001,
// equations 3.4 to 3.6).
//
//   F(light, view) = sum over j of F_j exp(sum over k of p_jk . psi_k - |p_jk|),  p = lambda xi
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "btf/direction.h"
#include "btf/vector.h"
#include "codecs/srbf/modes.h"

namespace weft::srbf {

/// J and K.
struct Shape {
  std::size_t kernels = 20;
  std::size_t modes = 3;

  std::size_t centres() const { return 3 * kernels * modes; }
  /// Centres and angles: what is not linear in F.
  std::size_t unknowns() const { return centres() + modes; }
  std::size_t colours() const { return 3 * kernels; }
  std::size_t numbers() const { return unknowns() + colours(); }
  bool operator==(const Shape&) const = default;
};

/// The paper's varpi of a texel: [j][k][xyz] of p, then [k] of the angles, then [j][rgb] of F_j.
class Kernels {
 public:
  Kernels() = default;
  explicit Kernels(Shape shape) : shape_(shape), values_(shape.numbers()) {}

  const Shape& shape() const { return shape_; }
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }
  std::span<double> unknowns() { return values().first(shape_.unknowns()); }
  std::span<const double> unknowns() const { return values().first(shape_.unknowns()); }
  double* centre(std::size_t j, std::size_t k) { return &values_[3 * (j * shape_.modes + k)]; }
  const double* centre(std::size_t j, std::size_t k) const {
    return &values_[3 * (j * shape_.modes + k)];
  }
  std::span<double> angles() { return values().subspan(shape_.centres(), shape_.modes); }
  std::span<const double> angles() const {
    return values().subspan(shape_.centres(), shape_.modes);
  }
  std::span<double> colours() { return values().last(shape_.colours()); }
  std::span<const double> colours() const { return values().last(shape_.colours()); }

 private:
  Shape shape_;
  std::vector<double> values_;
};

/// F of one pair, in double: the plain form of what fits and decoders compute side by side.
std::array<double, 3> evaluate(const Kernels& kernels, const Direction& light,
                               const Direction& view);

}  // namespace weft::srbf
