#include "codecs/srbf/kernel_order.h"

#include <algorithm>
#include <limits>

namespace weft::srbf {

namespace {

// [j][i]: what kernel i in the place of kernel j adds to the distance.
std::vector<double> place_costs(const Kernels& reference, const Kernels& kernels) {
  const std::size_t n = kernels.shape().kernels;
  const std::size_t centre = 3 * kernels.shape().modes;
  std::vector<double> costs(n * n);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      double& cost = costs[j * n + i];
      for (std::size_t m = 0; m < centre; ++m) {
        const double difference = reference.centre(j, 0)[m] - kernels.centre(i, 0)[m];
        cost += centre_metric * difference * difference;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const double difference = reference.colours()[3 * j + c] - kernels.colours()[3 * i + c];
        cost += difference * difference;
      }
    }
  }
  return costs;
}

// The Hungarian method, row by row: each row takes the column at the end of the shortest path that
// alternates between columns free to swap, by costs that potentials keep from falling below 0.
class Assignment {
 public:
  explicit Assignment(const std::vector<double>& costs, std::size_t n)
      : costs_(costs), n_(n), row_potential_(n), column_potential_(n + 1), row_of_(n + 1, none) {
    for (std::size_t row = 0; row < n; ++row) add(row);
  }

  /// The row of each column.
  std::size_t row_of(std::size_t column) const { return row_of_[column]; }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  void add(std::size_t row) {
    std::vector<double> shortest(n_, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(n_, n_);
    std::vector<char> visited(n_ + 1);
    std::size_t at = n_;  // a column that is not there, where the new row waits
    row_of_[n_] = row;
    while (row_of_[at] != none) {
      visited[at] = 1;
      const std::size_t from = row_of_[at];
      std::size_t next = n_;
      for (std::size_t column = 0; column < n_; ++column) {
        if (visited[column] != 0) continue;
        const double cost =
            costs_[from * n_ + column] - row_potential_[from] - column_potential_[column];
        if (cost < shortest[column]) {
          shortest[column] = cost;
          before[column] = at;
        }
        if (next == n_ || shortest[column] < shortest[next]) next = column;
      }
      const double step = shortest[next];
      for (std::size_t column = 0; column <= n_; ++column) {
        if (visited[column] != 0) {
          row_potential_[row_of_[column]] += step;
          column_potential_[column] -= step;
        } else {
          shortest[column] -= step;
        }
      }
      at = next;
    }
    for (; at != n_; at = before[at]) row_of_[at] = row_of_[before[at]];
    row_of_[n_] = none;
  }

  const std::vector<double>& costs_;
  std::size_t n_;
  std::vector<double> row_potential_;
  std::vector<double> column_potential_;
  std::vector<std::size_t> row_of_;  // of each column; the last waits
};

}  // namespace

double distance(const Kernels& a, const Kernels& b) {
  const std::size_t centres = a.shape().centres();
  double sum = 0;
  for (std::size_t i = 0; i < a.values().size(); ++i) {
    const double difference = a.values()[i] - b.values()[i];
    sum += (i < centres ? centre_metric : 1.0) * difference * difference;
  }
  return sum;
}

Kernels in_order_of(const Kernels& reference, const Kernels& kernels) {
  const Shape& shape = kernels.shape();
  const std::vector<double> costs = place_costs(reference, kernels);
  // What is not finite has no order.
  if (!std::ranges::all_of(
          costs, [](double cost) { return cost < std::numeric_limits<double>::infinity(); }))
    return kernels;
  const Assignment assignment(costs, shape.kernels);
  Kernels ordered = kernels;
  for (std::size_t i = 0; i < shape.kernels; ++i) {
    const std::size_t j = assignment.row_of(i);
    std::copy_n(kernels.centre(i, 0), 3 * shape.modes, ordered.centre(j, 0));
    std::copy_n(kernels.colours().begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                ordered.colours().begin() + static_cast<std::ptrdiff_t>(3 * j));
  }
  return ordered;
}

}  // namespace weft::srbf
