#include "codecs/stencil_batch.h"

#include <algorithm>

namespace weft {

namespace {

// Twice the signed area of p, q, r is affine in r: of x, of y, constant.
std::array<double, 3> side(const Vec2& p, const Vec2& q) {
  const double dx = static_cast<double>(q.x) - p.x;
  const double dy = static_cast<double>(q.y) - p.y;
  return {-dy, dx, dy * p.x - dx * p.y};
}

std::array<float, 9> affine_weights(const Vec2& a, const Vec2& b, const Vec2& c) {
  const std::array<std::array<double, 3>, 3> sides{side(b, c), side(c, a), side(a, b)};
  const double area = sides[2][0] * c.x + sides[2][1] * c.y + sides[2][2];
  std::array<float, 9> weights;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t k = 0; k < 3; ++k)
      weights[3 * corner + k] = static_cast<float>(sides[corner][k] / area);
  }
  return weights;
}

void ask_alone(const HemisphereSampling& sampling, const Direction& direction, int lane,
               StencilBatch& batch) {
  const Stencil stencil = sampling.locate(direction);
  for (std::size_t i = 0; i < 3; ++i) {
    batch.index[i][lane] = stencil.index[i];
    batch.weight[i][lane] = stencil.weight[i];
  }
}

}  // namespace

BatchLocator::BatchLocator(const HemisphereSampling& sampling) {
  const HemisphereSampling::Tables& tables = sampling.tables();
  for (const auto& t : tables.triangles) {
    weights_.push_back(
        affine_weights(tables.points[t[0]], tables.points[t[1]], tables.points[t[2]]));
  }
}

StencilBatch BatchLocator::locate(const HemisphereSampling& sampling,
                                  const std::array<Direction, batch_lanes>& directions) const {
  StencilBatch batch;
  if (weights_.empty()) {
    for (int lane = 0; lane < batch_lanes; ++lane)
      ask_alone(sampling, directions[lane], lane, batch);
    return batch;
  }
  const HemisphereSampling::Tables& tables = sampling.tables();
  constexpr int size = HemisphereSampling::grid_size;
  alignas(64) std::array<float, batch_lanes> x;
  alignas(64) std::array<float, batch_lanes> y;
  alignas(64) std::array<std::int32_t, batch_lanes> cell;
  for (int lane = 0; lane < batch_lanes; ++lane) {
    const Direction& d = directions[lane];
    x[lane] = d.x / (1 + d.z);
    y[lane] = d.y / (1 + d.z);
  }
  for (int lane = 0; lane < batch_lanes; ++lane) {
    const auto place = [](float p) {  // a NaN is 0
      const float q = (p + 1) * (size / 2.0F);
      return q > 0 ? static_cast<std::int32_t>(std::min(q, size - 1.0F)) : 0;
    };
    cell[lane] = place(y[lane]) * size + place(x[lane]);
  }
  const auto points = static_cast<std::int32_t>(sampling.size());
  for (int lane = 0; lane < batch_lanes; ++lane) {
    const std::uint16_t triangle = tables.grid[cell[lane]];
    const std::array<float, 9>& w = weights_[triangle];
    const auto& corners = tables.triangles[triangle];
    float least = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const float weight = w[3 * i] * x[lane] + w[3 * i + 1] * y[lane] + w[3 * i + 2];
      least = std::min(least, weight);
      // Points of the ring below the horizon hold zero.
      batch.index[i][lane] = corners[i] < points ? corners[i] : 0;
      batch.weight[i][lane] = corners[i] < points ? weight : 0;
    }
    if (!(least >= 0)) ask_alone(sampling, directions[lane], lane, batch);
  }
  return batch;
}

}  // namespace weft
