#include "codecs/cmf/low_rank.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace weft::cmf {

using factor_maps::DoubleLanes;

namespace {

constexpr int max_iterations = 60;
constexpr double tolerance = 1e-7;

using Vector = std::vector<DoubleLanes>;

// One power step on F^T F: u = F v and F^T u, in one pass over F.
struct Step {
  Vector u;
  Vector v;
};

Step power_step(const LaneVector& f, const Vector& v, std::size_t n_lights) {
  const std::size_t n_views = v.size();
  Step step{Vector(n_lights), Vector(n_views)};
  for (std::size_t i = 0; i < n_lights; ++i) {
    const Lanes* row = &f[i * n_views];
    DoubleLanes u;
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) u[k] += row[j][k] * v[j][k];
    }
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) step.v[j][k] += row[j][k] * u[k];
    }
    step.u[i] = u;
  }
  return step;
}

// To a largest value of 1 in each lane; answers the largest change against `before`.
double normalise(Vector& v, const Vector& before) {
  DoubleLanes largest;
  for (const DoubleLanes& value : v) {
    for (int k = 0; k < lane_count; ++k) largest[k] = std::max(largest[k], value[k]);
  }
  double change = 0;
  for (std::size_t j = 0; j < v.size(); ++j) {
    for (int k = 0; k < lane_count; ++k) {
      v[j][k] = largest[k] > 0 ? v[j][k] / largest[k] : 0;
      change = std::max(change, std::abs(v[j][k] - before[j][k]));
    }
  }
  return change;
}

float ratio_or(double numerator, double denominator, float otherwise) {
  return denominator > 0 ? static_cast<float>(numerator / denominator) : otherwise;
}

// P_i = sum_j f Q R / sum_j (Q R)^2.
Lanes solved_light(const Lanes* f, const Lanes* q, const LaneVector& view, const Lanes& before) {
  DoubleLanes top;
  DoubleLanes bottom;
  for (std::size_t j = 0; j < view.size(); ++j) {
    for (int k = 0; k < lane_count; ++k) {
      const double qr = q[j][k] * view[j][k];
      top[k] += f[j][k] * qr;
      bottom[k] += qr * qr;
    }
  }
  Lanes light;
  for (int k = 0; k < lane_count; ++k) light[k] = ratio_or(top[k], bottom[k], before[k]);
  return light;
}

// P, then R_j = sum_i w f P Q / sum_i w (P Q)^2 with the new P, in one pass over the pairs.
void solve_light_and_view(const LaneVector& f, const LaneVector& q,
                          std::span<const double> light_weights, LightView& factors) {
  const std::size_t n_views = factors.view.size();
  Vector top(n_views);
  Vector bottom(n_views);
  for (std::size_t i = 0; i < factors.light.size(); ++i) {
    const Lanes* f_row = &f[i * n_views];
    const Lanes* q_row = &q[i * n_views];
    const Lanes p = solved_light(f_row, q_row, factors.view, factors.light[i]);
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) {
        const double pq = p[k] * q_row[j][k];
        top[j][k] += light_weights[i] * f_row[j][k] * pq;
        bottom[j][k] += light_weights[i] * pq * pq;
      }
    }
    factors.light[i] = p;
  }
  for (std::size_t j = 0; j < n_views; ++j) {
    Lanes& r = factors.view[j];
    for (int k = 0; k < lane_count; ++k) r[k] = ratio_or(top[j][k], bottom[j][k], r[k]);
  }
}

// Of one term's solve alone, where it is begun.
constexpr int first_rounds = 3;

// e -= q (light' view' - light view) for what changed.
void subtract(const LaneVector& q, const Lanes* light, const Lanes* view, std::size_t n_lights,
              std::size_t n_views, LaneVector& error) {
  for (std::size_t i = 0; i < n_lights; ++i) {
    for (std::size_t j = 0; j < n_views; ++j) {
      const std::size_t pair = i * n_views + j;
      for (int k = 0; k < lane_count; ++k) error[pair][k] -= q[pair][k] * light[i][k] * view[j][k];
    }
  }
}

// The step that least squares asks for, cut where the value would fall below zero.
Lanes step_of(const DoubleLanes& top, const DoubleLanes& bottom, const Lanes& value, Sign sign) {
  Lanes step;
  for (int k = 0; k < lane_count; ++k) {
    step[k] = bottom[k] > 0 ? static_cast<float>(top[k] / bottom[k]) : 0.0F;
    if (sign == Sign::non_negative) step[k] = std::max(step[k], -value[k]);
  }
  return step;
}

// One term's light, then its view; `error` is f - q times all terms, before and after.
void solve_term(const LaneVector& q, std::span<const double> light_weights, Sign sign, Lanes* light,
                Lanes* view, std::size_t n_views, LaneVector& error) {
  Vector top(n_views);
  Vector bottom(n_views);
  for (std::size_t i = 0; i < light_weights.size(); ++i) {
    Lanes* e = &error[i * n_views];
    const Lanes* q_row = &q[i * n_views];
    DoubleLanes light_top;
    DoubleLanes light_bottom;
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) {
        const double qr = q_row[j][k] * view[j][k];
        light_top[k] += qr * e[j][k];
        light_bottom[k] += qr * qr;
      }
    }
    const Lanes step = step_of(light_top, light_bottom, light[i], sign);
    for (int k = 0; k < lane_count; ++k) light[i][k] += step[k];
    for (std::size_t j = 0; j < n_views; ++j) {
      for (int k = 0; k < lane_count; ++k) {
        e[j][k] -= q_row[j][k] * step[k] * view[j][k];
        const double pq = light[i][k] * q_row[j][k];
        top[j][k] += light_weights[i] * e[j][k] * pq;
        bottom[j][k] += light_weights[i] * pq * pq;
      }
    }
  }
  LaneVector steps(n_views);
  for (std::size_t j = 0; j < n_views; ++j) {
    steps[j] = step_of(top[j], bottom[j], view[j], sign);
    for (int k = 0; k < lane_count; ++k) view[j][k] += steps[j][k];
  }
  subtract(q, light, steps.data(), light_weights.size(), n_views, error);
}

// A further term from what is left above zero. Q may be zero at a pair, which then says nothing.
void begin_term(const LaneVector& q, std::span<const double> light_weights, std::size_t n_views,
                LaneVector& error, LightView& factors) {
  LaneVector left(error.size());
  LaneVector residual(error.size());
  for (std::size_t pair = 0; pair < error.size(); ++pair) {
    for (int k = 0; k < lane_count; ++k) {
      left[pair][k] = std::max(error[pair][k], 0.0F);
      residual[pair][k] = q[pair][k] > 0 ? left[pair][k] / q[pair][k] : 0.0F;
    }
  }
  const std::size_t n_lights = light_weights.size();
  LightView term = weighted_rank_one(left, q, light_weights, first_rounds,
                                     rank_one(residual, n_lights, n_views));
  subtract(q, term.light.data(), term.view.data(), n_lights, n_views, error);
  factors.light.insert(factors.light.end(), term.light.begin(), term.light.end());
  factors.view.insert(factors.view.end(), term.view.begin(), term.view.end());
}

}  // namespace

LightView rank_one(const LaneVector& f, std::size_t n_lights, std::size_t n_views) {
  DoubleLanes ones;
  std::fill_n(ones.lane, lane_count, 1.0);
  Vector v(n_views, ones);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    Vector next = power_step(f, v, n_lights).v;
    const double change = normalise(next, v);
    v = std::move(next);
    if (change < tolerance) break;
  }
  const Vector u = power_step(f, v, n_lights).u;
  DoubleLanes square;
  for (const DoubleLanes& value : v) {
    for (int k = 0; k < lane_count; ++k) square[k] += value[k] * value[k];
  }
  LightView result{LaneVector(n_lights), LaneVector(n_views)};
  for (std::size_t i = 0; i < n_lights; ++i) {
    for (int k = 0; k < lane_count; ++k) {
      result.light[i][k] = square[k] > 0 ? static_cast<float>(u[i][k] / square[k]) : 0.0F;
    }
  }
  for (std::size_t j = 0; j < n_views; ++j) {
    for (int k = 0; k < lane_count; ++k) result.view[j][k] = static_cast<float>(v[j][k]);
  }
  return result;
}

LightView weighted_rank_one(const LaneVector& f, const LaneVector& q,
                            std::span<const double> light_weights, int rounds, LightView start) {
  for (int round = 0; round < rounds; ++round) solve_light_and_view(f, q, light_weights, start);
  return start;
}

LightView weighted_low_rank(const LaneVector& f, const LaneVector& q,
                            std::span<const double> light_weights, int terms, Sign sign, int rounds,
                            LightView start) {
  if (terms == 1) return weighted_rank_one(f, q, light_weights, rounds, std::move(start));
  const std::size_t n_lights = light_weights.size();
  const std::size_t n_views = f.size() / n_lights;
  LaneVector error = f;
  for (std::size_t term = 0; term < start.light.size() / n_lights; ++term) {
    subtract(q, &start.light[term * n_lights], &start.view[term * n_views], n_lights, n_views,
             error);
  }
  while (start.light.size() < terms * n_lights) {
    begin_term(q, light_weights, n_views, error, start);
  }
  for (int round = 0; round < rounds; ++round) {
    for (int term = 0; term < terms; ++term) {
      solve_term(q, light_weights, sign, &start.light[term * n_lights], &start.view[term * n_views],
                 n_views, error);
    }
  }
  return start;
}

LaneVector sum_of_terms(const LightView& factors, std::size_t n_lights, std::size_t n_views) {
  LaneVector sum(n_lights * n_views);
  for (std::size_t term = 0; term < factors.light.size() / n_lights; ++term) {
    const Lanes* light = &factors.light[term * n_lights];
    const Lanes* view = &factors.view[term * n_views];
    for (std::size_t pair = 0; pair < sum.size(); ++pair) {
      for (int k = 0; k < lane_count; ++k) {
        sum[pair][k] += light[pair / n_views][k] * view[pair % n_views][k];
      }
    }
  }
  for (Lanes& value : sum) {
    for (int k = 0; k < lane_count; ++k) value[k] = std::max(value[k], 0.0F);
  }
  return sum;
}

void balance_terms(LightView& factors, std::size_t n_lights, std::size_t n_views) {
  const auto largest = [](std::span<const Lanes> values, int k) {
    float result = 0;
    for (const Lanes& value : values) result = std::max(result, std::abs(value[k]));
    return result;
  };
  for (std::size_t term = 0; term < factors.light.size() / n_lights; ++term) {
    const std::span light(&factors.light[term * n_lights], n_lights);
    const std::span view(&factors.view[term * n_views], n_views);
    for (int k = 0; k < lane_count; ++k) {
      const float of_light = largest(light, k);
      const float of_view = largest(view, k);
      const bool there = of_light > 0 && of_view > 0;
      const float scale = there ? std::sqrt(of_view / of_light) : 0.0F;
      for (Lanes& value : light) value[k] *= scale;
      for (Lanes& value : view) value[k] *= there ? 1 / scale : 0.0F;
    }
  }
}

}  // namespace weft::cmf
