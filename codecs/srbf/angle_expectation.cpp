#include "codecs/srbf/angle_expectation.h"

#include <cmath>
#include <numbers>

#include "codecs/srbf/modes.h"

namespace weft::srbf {

namespace {

double product(const double (&a)[3], const Direction& b) {  // NOLINT
  return a[0] * b.x + a[1] * b.y + a[2] * b.z;
}

}  // namespace

void AngleExpectation::add(const double (&pull)[3], const Direction& light,  // NOLINT
                           const Direction& view) {
  samples_.push_back({product(pull, light), product(pull, view), light ^ view});
}

double AngleExpectation::operator()(double angle) const {
  const double a = std::cos(angle);
  const double b = std::sin(angle);
  double sum = 0;
  for (const Sample& s : samples_)
    sum += (a * s.light + b * s.view) / std::sqrt(1 + 2 * a * b * s.cosine + smallest_square);
  return sum;
}

// By golden section; where Q has two peaks it may end on the lower one, and then nothing moves.
double AngleExpectation::best_near(double angle) const {
  constexpr double reach = std::numbers::pi / 8;
  constexpr double enough = 1e-4;
  constexpr double ratio = 1 / std::numbers::phi;
  double low = angle - reach;
  double high = angle + reach;
  double left = high - ratio * (high - low);
  double right = low + ratio * (high - low);
  double at_left = (*this)(left);
  double at_right = (*this)(right);
  while (high - low > enough) {
    if (at_left > at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - ratio * (high - low);
      at_left = (*this)(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + ratio * (high - low);
      at_right = (*this)(right);
    }
  }
  const double found = (low + high) / 2;
  return (*this)(found) > (*this)(angle) ? found : angle;
}

}  // namespace weft::srbf
