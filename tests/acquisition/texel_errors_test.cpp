// Stated standard errors against the spread over independent runs; and what of noise and coverage
// survives on disk.
#include <cmath>
#include <numeric>

#include "acquisition/acquire.h"
#include "acquisition/view_tracer.h"
#include "btf/btf_file.h"
#include "btf/hemisphere_sampling.h"
#include "btf/random.h"
#include "tests/acquisition/known_structures.h"
#include "tests/statistics.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

// Mean and variance of numbers that come one by one, a place each.
class Spread {
 public:
  void add(std::span<const float> values) {
    sums_.resize(values.size());
    squares_.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      sums_[i] += values[i];
      squares_[i] += static_cast<double>(values[i]) * values[i];
    }
    ++count_;
  }
  std::size_t size() const { return sums_.size(); }
  double mean(std::size_t i) const { return sums_[i] / count_; }
  double mean_square(std::size_t i) const { return squares_[i] / count_; }
  double variance(std::size_t i) const {
    return std::max(0.0, squares_[i] / count_ - mean(i) * mean(i)) * count_ / (count_ - 1);
  }

 private:
  std::vector<double> sums_;
  std::vector<double> squares_;
  double count_ = 0;
};

// Tile means (mean of RGB), one a light.
std::vector<float> pair_means(const TracedView& traced, std::size_t lights) {
  const std::size_t n = traced.values.size() / lights;
  std::vector<float> means;
  for (std::size_t l = 0; l < lights; ++l) {
    const auto begin = traced.values.begin() + static_cast<std::ptrdiff_t>(l * n);
    means.push_back(
        static_cast<float>(std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(n), 0.0) /
                           static_cast<double>(n)));
  }
  return means;
}

struct Comparison {
  double ratio = 0;        // stated over true variance, in the mean over places
  double understated = 0;  // share of places whose spread is larger than stated, p < 1e-3
};

Comparison compare(const Spread& values, const Spread& errors, int runs) {
  Comparison result;
  double stated = 0;
  double found = 0;
  int places = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double claim = errors.mean_square(i);
    stated += claim;
    found += values.variance(i);
    if (claim == 0) {
      CHECK(values.variance(i) < 1e-14);
      continue;
    }
    ++places;
    const double p = statistics::chi2_p_value((runs - 1) * values.variance(i) / claim, runs - 1.0);
    result.understated += p < 1e-3 ? 1 : 0;
  }
  result.ratio = stated / found;
  result.understated /= places;
  return result;
}

// Stratification between groups of samples is not credited, so what is stated may be more than the
// spread, up to twice (in variance four times); never less, but for chance.
void expect_true(const Mesostructure& structure, int max_bounces, int spp) {
  constexpr int runs = 64;
  const ViewTracer tracer(structure, named_directions("fibonacci:12"),
                          {.width = 8,
                           .height = 8,
                           .spp = spp,
                           .max_bounces = max_bounces,
                           .texel_errors = true,
                           .seed = 0});
  Spread values, errors, means, pair_errors;
  for (std::uint64_t run = 0; run < runs; ++run) {
    const TracedView traced = tracer.trace(from_spherical(0.9, 4.0), run);
    REQUIRE(traced.texel_errors.size() == traced.values.size());
    REQUIRE(traced.standard_errors.size() == tracer.lights().size());
    values.add(traced.values);
    errors.add(traced.texel_errors);
    means.add(pair_means(traced, tracer.lights().size()));
    pair_errors.add(traced.standard_errors);
  }
  const Comparison texels = compare(values, errors, runs);
  const Comparison pairs = compare(means, pair_errors, runs);
  INFO("bounces " << max_bounces << ", spp " << spp << "; stated over true variance: of values "
                  << texels.ratio << ", of pairs " << pairs.ratio
                  << "; understated: " << texels.understated << ", " << pairs.understated);
  CHECK(texels.ratio > 0.95);
  CHECK(texels.ratio < 4);
  CHECK(pairs.ratio > 0.9);
  CHECK(pairs.ratio < 4);
  CHECK(texels.understated < 2e-3);
  CHECK(pairs.understated == 0);
}

}  // namespace

TEST_CASE("standard errors tell the spread over independent runs, of every value and every pair",
          "[heavy]") {
  expect_true(test::checker(64), 0, 64);
  expect_true(test::checker(64), 4, 16);
  expect_true(test::checker(64), 4, 64);
  expect_true(test::checker(64), 4, 256);
}

TEST_CASE("the variance part and coverage survive the way to disk and back") {
  const TemporaryFolder folder;
  const std::vector<Direction> lights = named_directions("fibonacci:3");
  const int width = 5;
  const int height = 4;
  std::vector<float> values, errors, coverage;
  for (int i = 0; i < 3 * 3 * width * height; ++i) {
    values.push_back(unit_float(hash_coordinates(i, 0)));
    errors.push_back(1e-3F * unit_float(hash_coordinates(i, 1)));
  }
  for (int i = 0; i < width * height; ++i) coverage.push_back(unit_float(hash_coordinates(i, 2)));
  const std::vector<float> pair_errors = {1e-5F, 2e-5F, 3e-5F};
  for (const PixelType type : {PixelType::half, PixelType::float32}) {
    const auto path = folder.path / (type == PixelType::half ? "half.exr" : "float.exr");
    write_view_file(path, {width, height, type, "{}"}, {0, 0, 1}, lights,
                    {.values = values,
                     .standard_errors = pair_errors,
                     .texel_errors = errors,
                     .coverage = coverage});
    // A half has 11 bits, and below 6e-5 steps of 6e-8.
    const double rounding = type == PixelType::half ? 1.0 / 2048 : 1e-7;
    const auto expect_near = [&](const std::vector<float>& read, const std::vector<float>& wrote) {
      REQUIRE(read.size() == wrote.size());
      for (std::size_t i = 0; i < read.size(); ++i)
        REQUIRE(read[i] ==
                Approx(wrote[i]).epsilon(rounding).margin(type == PixelType::half ? 3e-8 : 0));
    };
    expect_near(read_view_values(path, width, height, 3), values);
    expect_near(read_texel_errors(path, width, height, 3), errors);
    expect_near(read_coverage(path, width, height), coverage);
    CHECK(read_view_notes(path).standard_errors == pair_errors);
  }
  const auto plain = folder.path / "plain.exr";
  write_view_file(plain, {width, height, PixelType::half, "{}"}, {0, 0, 1}, lights,
                  {.values = values});
  CHECK(read_texel_errors(plain, width, height, 3).empty());
  CHECK(read_coverage(plain, width, height).empty());
  CHECK(read_view_notes(plain).standard_errors.empty());
}

TEST_CASE("coverage is the share of a texel's rays that hit above the cut") {
  const auto mean_coverage = [](float cut, const Direction& view) {
    const ViewTracer tracer(
        test::checker(256), {{0, 0, 1}},
        {.width = 32, .height = 32, .spp = 64, .max_bounces = 0, .cut_height = cut, .seed = 4});
    const TracedView traced = tracer.trace(view, 0);
    REQUIRE(traced.coverage.size() == 1024);
    double sum = 0;
    for (const float c : traced.coverage) {
      REQUIRE(c >= 0);
      REQUIRE(c <= 1);
      sum += c;
    }
    return sum / 1024;
  };
  const Direction above(0, 0, 1);
  CHECK(mean_coverage(-0.01F, above) == 1);
  CHECK(mean_coverage(0.16F, above) == 0);
  // Half of the checker lies above its middle, seen from above; more where pads hide what is low.
  CHECK(mean_coverage(0.075F, above) == Approx(0.5).margin(2e-3));
  const double tilted = mean_coverage(0.075F, from_spherical(radians(80.0), 0.5));
  CHECK(tilted > 0.6);
  CHECK(tilted < 1);
  // And the share that its formula has above a height near the top.
  constexpr int n = 1000;
  int higher = 0;
  for (int i = 0; i < n * n; ++i) {
    const double s = std::sin(2 * std::numbers::pi * (i % n + 0.5) / n) *
                     std::sin(2 * std::numbers::pi * (i / n + 0.5) / n);
    higher += 0.075 * (1 + s / std::sqrt(s * s + 0.02)) >= 0.14 ? 1 : 0;
  }
  CHECK(mean_coverage(0.14F, above) == Approx(static_cast<double>(higher) / (n * n)).margin(3e-3));
}

TEST_CASE("coverage lies where the pads are") {
  const ViewTracer tracer(
      test::checker(256), {{0, 0, 1}},
      {.width = 4, .height = 4, .spp = 64, .max_bounces = 0, .cut_height = 0.075F, .seed = 4});
  const TracedView traced = tracer.trace({0, 0, 1}, 0);
  // sin(2 pi x) sin(2 pi y) > 0 in the quarters at the top right and the bottom left; row 0 is the
  // top.
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      INFO(x << ", " << y);
      CHECK(traced.coverage[4 * y + x] == Approx((x < 2) == (y >= 2) ? 1 : 0).margin(1e-3));
    }
  }
}

TEST_CASE("a dataset with parts for errors and coverage reads as the one without") {
  const TemporaryFolder folder;
  AcquisitionSettings settings;
  settings.trace = {.width = 6, .height = 5, .spp = 8, .max_bounces = 1, .seed = 3};
  settings.views = "regular:2x3";
  settings.lights = "fibonacci:4";
  Progress silent;
  acquire(test::checker(16), settings, folder.path / "plain.btf", silent);
  settings.trace.texel_errors = true;
  settings.trace.cut_height = 0.075F;
  acquire(test::checker(16), settings, folder.path / "full.btf", silent);
  const Btf plain = read_btf(folder.path / "plain.btf");
  const Btf full = read_btf(folder.path / "full.btf");
  REQUIRE(plain.halfs().size() == full.halfs().size());
  CHECK(std::ranges::equal(plain.halfs(), full.halfs()));
  CHECK(read_btf_header(folder.path / "plain.btf").standard_errors ==
        read_btf_header(folder.path / "full.btf").standard_errors);
  CHECK(corrupted_files(folder.path / "full.btf").empty());
  CHECK(read_texel_errors(folder.path / "plain.btf/view_001.exr", 6, 5, 4).empty());
  const auto errors = read_texel_errors(folder.path / "full.btf/view_001.exr", 6, 5, 4);
  const auto pairs = read_view_notes(folder.path / "full.btf/view_001.exr").standard_errors;
  REQUIRE(errors.size() == 3 * 4 * 6 * 5);
  REQUIRE(pairs.size() == 4);
  // Texels are independent: a pair's variance is the sum of theirs (here of RGB, which vary
  // together, so between the mean of the channels' and a third of it).
  for (std::size_t l = 0; l < 4; ++l) {
    double sum = 0;
    for (std::size_t i = 0; i < 90; ++i) sum += std::pow(errors[90 * l + i], 2) / 3 / 900;
    CHECK(pairs[l] < 1.001 * std::sqrt(sum));
    CHECK(pairs[l] > 0.5 * std::sqrt(sum));
  }
  CHECK(read_coverage(folder.path / "full.btf/view_001.exr", 6, 5).size() == 30);
}
