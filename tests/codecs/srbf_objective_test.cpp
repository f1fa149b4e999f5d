// What SRBF fits minimise and how: the error and its gradient are what definitions and differences
// say, levels are filtered as they should be, and what diverges leaves its start.

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "codecs/srbf/lanes.h"
#include "codecs/srbf/minimise.h"
#include "codecs/srbf/mip_levels.h"
#include "codecs/srbf/objective.h"
#include "codecs/srbf/texel_fit.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/codecs/synthetic_kernels.h"

using namespace weft;
using namespace weft::srbf;

TEST_CASE("SRBF: exponentials side by side are the library's to 3e-7") {
  for (int i = 0; i < 4000; ++i) {
    const float x = -0.0217F * static_cast<float>(i);
    const Wide found = exp_below_zero(Wide{} + x);
    REQUIRE(found[i % wide_lanes] == Approx(std::exp(x)).epsilon(3e-7).margin(1e-37));
  }
  CHECK(exp_below_zero(Vec4{} - 1e30F)[0] < 1e-37F);
  CHECK(std::isnan(exp_below_zero(Vec4{} + std::numeric_limits<float>::quiet_NaN())[0]));
}

TEST_CASE("SRBF: the objective is what its definition says, and its colours are the best") {
  const auto btf = realistic_btf(2, "regular:3x6");
  const Samples samples(btf->views(), btf->lights(), Quantity::over_cosine);
  const std::vector<float> texel = texel_of(*btf, samples);
  const double ridge = 1e-3;
  Objective objective(samples, {5, 3}, Ridge{0, ridge, 0});
  objective.set_texel(texel);
  Kernels kernels = some_kernels({5, 3}, 6);
  const Objective::Value value = objective(kernels, {}, true);
  const auto defined = [&](const Kernels& tried) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.pairs; ++i) {
      const Direction& light = btf->lights()[i % btf->lights().size()];
      const auto f = evaluate(tried, light, btf->views()[i / btf->lights().size()]);
      for (std::size_t c = 0; c < 3; ++c)
        sum += std::pow(f[c] * light.z - texel[c * samples.count + i], 2);
    }
    sum /= 3.0 * static_cast<double>(samples.pairs);
    for (const double colour : tried.colours()) sum += ridge * colour * colour;
    return sum;
  };
  CHECK(value.total == Approx(defined(kernels)).epsilon(1e-5));
  for (std::size_t i = 0; i < kernels.colours().size(); ++i) {
    for (const double step : {-0.01, 0.01}) {
      Kernels other = kernels;
      other.colours()[i] += step;
      CHECK(defined(other) > defined(kernels));
    }
  }
}

TEST_CASE("SRBF: the gradient is what central differences say") {
  const auto btf = realistic_btf(2, "regular:3x6");
  for (const Quantity quantity : {Quantity::radiance, Quantity::over_cosine}) {
    const Samples samples(btf->views(), btf->lights(), quantity);
    const std::vector<float> texel = texel_of(*btf, samples, 1, 1);
    for (std::size_t modes = 1; modes <= most_modes; ++modes) {
      const Shape shape{7, modes};
      Objective objective(samples, shape, Ridge{1e-4, 1e-3, 1e-2});
      objective.set_texel(texel);
      const Kernels target = some_kernels(shape, 3, 1);
      objective.set_pull({{2e-5, 3e-4, 1e-4}, {target.values().begin(), target.values().end()}});
      Kernels kernels = some_kernels(shape, 6);
      std::vector<double> gradient(shape.unknowns());
      objective(kernels, gradient, true);
      // Angles move all centres at once: their derivatives are the larger ones. Sums are of floats:
      // where steps are shorter than these, rounding shows (4e-3: up to 2e-3 of the largest), where
      // they are longer, the fifth derivative.
      double of_centres = 0;
      double of_angles = 0;
      for (std::size_t i = 0; i < shape.unknowns(); ++i) {
        double& largest = i < shape.centres() ? of_centres : of_angles;
        largest = std::max(largest, std::abs(gradient[i]));
      }
      for (std::size_t i = 0; i < shape.unknowns(); ++i) {
        const double step = 2e-2;
        const auto at = [&](double offset) {
          Kernels moved = kernels;
          moved.values()[i] += offset;
          return objective(moved, {}, true).total;
        };
        const double difference =
            (8 * (at(step) - at(-step)) - (at(2 * step) - at(-2 * step))) / (12 * step);
        INFO("modes " << modes << ", unknown " << i);
        const double largest = i < shape.centres() ? of_centres : of_angles;
        CHECK(std::abs(gradient[i] - difference) < 1.5e-3 * largest);
      }
    }
  }
}

TEST_CASE("SRBF: the gradient is what differences say at and beside centres of no length") {
  // |p| is rounded off within 1e-3 of 0, where steps must be so short that sums are in double here;
  // colours stay what they are, since they are the best.
  const auto btf = realistic_btf(2, "regular:3x6");
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  const std::vector<float> texel = texel_of(*btf, samples, 1, 1);
  Objective objective(samples, {4, 3}, Ridge{0, 1e-3, 0});
  objective.set_texel(texel);
  Kernels kernels = some_kernels({4, 3}, 3);
  for (int c = 0; c < 3; ++c) {
    kernels.centre(0, 1)[c] = 0;
    kernels.centre(2, 0)[c] = c == 1 ? 4e-4 : 0;
  }
  std::vector<double> gradient(kernels.shape().unknowns());
  objective(kernels, gradient, true);
  const auto error = [&](const Kernels& tried) {
    double sum = 0;
    for (std::size_t i = 0; i < samples.pairs; ++i) {
      const auto b = evaluate(tried, btf->lights()[i % btf->lights().size()],
                              btf->views()[i / btf->lights().size()]);
      for (std::size_t c = 0; c < 3; ++c) sum += std::pow(b[c] - texel[c * samples.count + i], 2);
    }
    return sum / (3.0 * static_cast<double>(samples.pairs));
  };
  double largest = 0;
  for (const double g : gradient) largest = std::max(largest, std::abs(g));
  for (const double* centre : {kernels.centre(0, 1), kernels.centre(2, 0)}) {
    for (int c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(centre + c - kernels.values().data());
      const auto at = [&](double offset) {
        Kernels moved = kernels;
        moved.values()[i] += offset;
        return error(moved);
      };
      const double step = 2e-5;
      CHECK(std::abs(gradient[i] - (at(step) - at(-step)) / (2 * step)) < 2e-3 * largest);
    }
  }
}

TEST_CASE("SRBF: three half-way modes are one, the univariate form") {
  const Kernels three = [] {
    Kernels kernels = some_kernels({4, 3}, 3);
    std::ranges::fill(kernels.angles(), std::numbers::pi / 4);
    return kernels;
  }();
  Kernels one({4, 1});
  one.angles()[0] = std::numbers::pi / 4;
  for (std::size_t j = 0; j < 4; ++j) {
    double lengths = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double* p = three.centre(j, k);
      for (std::size_t c = 0; c < 3; ++c) one.centre(j, 0)[c] += p[c];
      lengths += smooth_length(p[0], p[1], p[2]);
    }
    const double* sum = one.centre(j, 0);
    for (std::size_t c = 0; c < 3; ++c) {
      one.colours()[3 * j + c] =
          three.colours()[3 * j + c] * std::exp(smooth_length(sum[0], sum[1], sum[2]) - lengths);
    }
  }
  for (const Direction& light : named_directions("fibonacci:20")) {
    for (const Direction& view : named_directions("fibonacci:20"))
      CHECK(evaluate(one, light, view)[1] == Approx(evaluate(three, light, view)[1]).epsilon(1e-4));
  }
}

TEST_CASE("SRBF: Lanczos's weights sum to one, repeat, and keep what is constant") {
  for (const auto& [coarse, fine] :
       {std::pair(4, 8), std::pair(2, 5), std::pair(1, 1), std::pair(1, 3), std::pair(32, 64)}) {
    for (int i = 0; i < coarse; ++i) {
      double sum = 0;
      for (const AxisTap& tap : lanczos_taps(i, coarse, fine)) {
        CHECK(tap.texel >= 0);
        CHECK(tap.texel < fine);
        sum += tap.weight;
      }
      CHECK(sum == Approx(1));
    }
  }
  // Equation 3.12 at x = 1/4, 3/4, ... for halving, before it is normalised.
  const auto taps = lanczos_taps(8, 16, 32);
  REQUIRE(taps.size() == 12);
  CHECK(taps[6].texel == 17);
  CHECK(taps[7].weight / taps[6].weight == Approx(0.270190 / 0.890067).epsilon(1e-4));
  const auto btf =
      synthetic_btf(5, 3, "regular:2x4", "regular:2x4",
                    [](int, int, const Direction&, const Direction&) { return Rgb(1, 2, 3); });
  const MipLevels levels(*btf);
  CHECK(levels.sizes().levels() == 3);
  std::vector<float> coarsest(3 * 64);
  levels.abrdf(2, 0, coarsest);
  CHECK(coarsest[1] == Approx(2 * btf->lights()[0].z));
}

TEST_CASE("SRBF: what diverges leaves its start") {
  std::vector<double> x = {1, 2, 3};
  const auto not_finite = [](std::span<const double>, std::span<double> gradient) {
    std::ranges::fill(gradient, 1.0);
    return std::numeric_limits<double>::quiet_NaN();
  };
  CHECK(!minimise(x, not_finite, {}));
  CHECK(x == std::vector<double>{1, 2, 3});
  // A valley that ends at a wall of infinity: the best point so far comes back.
  const auto wall = [](std::span<const double> at, std::span<double> gradient) {
    for (std::size_t i = 0; i < 3; ++i) gradient[i] = -1;
    const double sum = at[0] + at[1] + at[2];
    return sum > 9 ? std::numeric_limits<double>::infinity() : -sum;
  };
  CHECK(minimise(x, wall, {}));
  CHECK(x[0] + x[1] + x[2] >= 6);
  CHECK(x[0] + x[1] + x[2] <= 9);

  const auto btf = realistic_btf(1, "regular:3x6");
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  std::vector<float> texel = texel_of(*btf, samples);
  const Modes modes = modes_named("optimal", 3, true);
  TexelFitter fitter(samples, modes, 4);
  fitter.set_texel(texel);
  const TexelFit good = fitter.as_it_is(some_kernels({4, 3}, 3));
  texel[5] = std::numeric_limits<float>::infinity();
  const TexelFit end = fitter.descend(good, {});
  CHECK(end.fell_back);
  CHECK(std::ranges::equal(end.kernels.values(), good.kernels.values()));
}
