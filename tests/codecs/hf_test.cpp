// HF against data whose logarithm is known, and its one sparse system against its equations.

#include <fmt/core.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "btf/random.h"
#include "codecs/hf/cross_validation.h"
#include "codecs/hf/log_system.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/temporary_folder.h"

using namespace weft;
using namespace weft::hf;
using factor_maps::lane_count;
using factor_maps::ParabolicMap;

namespace {

double hf_error(const std::shared_ptr<const Btf>& btf, const std::vector<std::string>& parameters) {
  Progress progress;
  const auto fitted =
      codec_named("hf").fit(btf, Settings::from_text("", "test", parameters), progress);
  return sample_error(*btf, *fitted).relative_rmse;
}

std::shared_ptr<const Btf> product_btf() {
  return synthetic_btf(3, 2, "ubo81", "ubo81",
                       [](int x, int y, const Direction& l, const Direction& v) {
                         return light_pattern(x, y, l) * half_pattern(x, y, (l + v).normalized()) *
                                view_pattern(x, y, v);
                       });
}

DoubleVector wavy(std::size_t size) {
  DoubleVector values(size);
  for (std::size_t i = 0; i < size; ++i) {
    for (int k = 0; k < lane_count; ++k) values[i][k] = std::sin(0.7 * static_cast<double>(i) + k);
  }
  return values;
}

}  // namespace

TEST_CASE("Data that is P Q R comes back from its logarithm") {
  const auto btf = product_btf();
  const double in_floats =
      hf_error(btf, {"bits=float", "clustered=false", "lambda=0.001", "floor=0.001"});
  const double in_bytes = hf_error(btf, {"clustered=false", "lambda=0.001", "floor=0.001"});
  const double smoothed =
      hf_error(btf, {"bits=float", "clustered=false", "lambda=30", "floor=0.001"});
  INFO("floats " << in_floats << ", bytes " << in_bytes << ", smoothed " << smoothed);
  CHECK(in_floats < 0.01);
  CHECK(in_bytes < 0.03);
  CHECK(smoothed > 2 * in_floats);
}

namespace {

// Each texel less the mean of its neighbours within its map, or the transposed of that.
DoubleVector laplacian(const DoubleVector& x, int resolution, bool transposed) {
  DoubleVector result = x;
  for (int i = 0; i < static_cast<int>(x.size()); ++i) {
    const int column = i % resolution;
    const int row = i / resolution % resolution;
    std::vector<int> near;
    if (column > 0) near.push_back(i - 1);
    if (column < resolution - 1) near.push_back(i + 1);
    if (row > 0) near.push_back(i - resolution);
    if (row < resolution - 1) near.push_back(i + resolution);
    for (const int j : near) {
      for (int k = 0; k < lane_count; ++k) {
        const double share = 1.0 / static_cast<double>(near.size());
        if (transposed)
          result[j][k] -= share * x[i][k];
        else
          result[i][k] -= share * x[j][k];
      }
    }
  }
  return result;
}

double product(const DoubleVector& a, const DoubleVector& b, int lane) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i][lane] * b[i][lane];
  return sum;
}

}  // namespace

TEST_CASE("The lookup of logarithms is the sum of three bilinear ones, and has its transposed") {
  const HemisphereSampling lights(named_directions("regular:3x7"));
  const HemisphereSampling views(named_directions("fibonacci:23"));
  const LogLookup lookup(lights, views, ParabolicMap(7));
  const DoubleVector x = wavy(lookup.unknowns());
  const DoubleVector answers = lookup.times(x);
  for (std::size_t pair = 0; pair < lookup.pairs(); ++pair) {
    const Direction& l = lights[pair / views.size()];
    const Direction& v = views[pair % views.size()];
    double sum = 0;
    int map = 0;
    for (const Direction& d : {l, (l + v).normalized(), v}) {
      const auto taps = ParabolicMap(7).taps(d);
      for (std::size_t t = 0; t < 4; ++t) sum += taps.weight[t] * x[49 * map + taps.index[t]][5];
      ++map;
    }
    REQUIRE(answers[pair][5] == Approx(sum));
  }
  const DoubleVector f = wavy(lookup.pairs());
  for (const int k : {0, 17, lane_count - 1}) {
    CHECK(product(f, answers, k) == Approx(product(lookup.transposed_times(f), x, k)));
  }
}

TEST_CASE("The factored system is solved in every lane") {
  const HemisphereSampling lights(named_directions("regular:3x7"));
  const HemisphereSampling views(named_directions("fibonacci:23"));
  constexpr int resolution = 7;
  constexpr double lambda = 0.3;
  const LogLookup lookup(lights, views, ParabolicMap(resolution));
  const LogSystem system(lookup, resolution, lambda);
  DoubleVector right = lookup.transposed_times(wavy(lookup.pairs()));
  const DoubleVector x = system.solve(right);
  const DoubleVector data = lookup.transposed_times(lookup.times(x));
  const DoubleVector smooth = laplacian(laplacian(x, resolution, false), resolution, true);
  const auto samples = static_cast<double>(lookup.pairs());
  const auto texels = static_cast<double>(lookup.unknowns());
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (int k = 0; k < lane_count; ++k) {
      const double left = data[i][k] / samples + lambda * lambda * smooth[i][k] / texels;
      REQUIRE(left == Approx(right[i][k]).margin(1e-4));
    }
  }
}

TEST_CASE(
    "The ridge shares a constant evenly between the factors, which nothing else would settle") {
  const HemisphereSampling directions(named_directions("ubo81"));
  constexpr int resolution = 9;
  const LogLookup lookup(directions, directions, ParabolicMap(resolution));
  const LogSystem system(lookup, resolution, 0.5);
  DoubleVector ones(lookup.pairs());
  for (DoubleLanes& value : ones) {
    for (int k = 0; k < lane_count; ++k) value[k] = 3.0 / static_cast<double>(lookup.pairs());
  }
  const DoubleVector x = system.solve(lookup.transposed_times(ones));
  for (const DoubleLanes& texel : x) REQUIRE(texel[7] == Approx(1).margin(0.01));
}

TEST_CASE("What is black is lifted to the floor, a share of the ABRDF's mean") {
  // Black where the light comes from one side: there the product is the floor over what is bright.
  const auto btf =
      synthetic_btf(1, 1, "ubo81", "ubo81", [](int, int, const Direction& l, const Direction&) {
        return l.x < 0 ? Rgb(0, 0, 0) : Rgb(1, 2, 4);
      });
  const auto lifted = [&](const std::string& floor) {
    Progress progress;
    const auto parameters = Settings::from_text(
        "", "test",
        {"bits=float", "clustered=false", "lambda=0.001", "refit_scale=false", "floor=" + floor});
    const auto fitted = codec_named("hf").fit(btf, parameters, progress);
    double sum = 0;
    int count = 0;
    for (const Direction& light : btf->lights().directions()) {
      if (light.x > -0.3F || light.z < 0.1F) continue;
      sum += fitted->evaluate({0.5F, 0.5F}, light, {0, 0, 1}, 0).x / light.z;
      ++count;
    }
    return sum / count;
  };
  double mean = 0;
  for (const Direction& light : btf->lights().directions()) mean += light.x < 0 ? 0 : 1;
  mean /= static_cast<double>(btf->lights().size());
  for (const double floor : {0.01, 0.1}) {
    INFO(floor);
    CHECK(lifted(std::to_string(floor)) == Approx(floor * mean).epsilon(0.2));
  }
}

TEST_CASE("Cross validation smooths noise, and leaves clean data alone") {
  const HemisphereSampling lights(named_directions("ubo81"));
  constexpr int resolution = 16;
  const LogLookup lookup(lights, lights, ParabolicMap(resolution));
  DoubleVector clean(lookup.pairs());
  DoubleVector noise(lookup.pairs());
  for (std::size_t pair = 0; pair < clean.size(); ++pair) {
    const Direction& l = lights[pair / lights.size()];
    const Direction& v = lights[pair % lights.size()];
    for (int k = 0; k < lane_count; ++k) {
      clean[pair][k] = std::sin(9 * l.x + k) + std::cos(9 * v.y) * v.x;
      const double hash = std::sin(static_cast<double>(pair) * 78.233 + 12.9898 * k) * 43758.5453;
      noise[pair][k] = hash - std::floor(hash) - 0.5;
    }
  }
  const auto found = [&](const DoubleVector& log_f) {
    return cross_validated_lambda(lookup, resolution, log_f, [&](const DoubleVector& x) {
      const DoubleVector fitted = lookup.times(x);
      double sum = 0;
      for (std::size_t pair = 0; pair < fitted.size(); ++pair) {
        for (int k = 0; k < lane_count; ++k) sum += std::pow(fitted[pair][k] - log_f[pair][k], 2);
      }
      return sum;
    });
  };
  const double of_clean = found(clean);
  const double of_noise = found(noise);
  INFO("clean " << of_clean << ", noise " << of_noise);
  CHECK(of_clean < 0.05);
  CHECK(of_noise > 10 * of_clean);
}

TEST_CASE("What the Laplacian extrapolates does not take the steps of 8 bits") {
  // Brightness grows towards the horizon, beyond which the maps are not touched.
  const auto btf =
      synthetic_btf(2, 2, "ubo81", "ubo81", [](int x, int, const Direction& l, const Direction& v) {
        const float power = 3.0F + static_cast<float>(x);
        return Rgb(1, 1, 1) * std::exp(power * (l.x * l.x + l.y * l.y)) * (1 + v.x * v.x);
      });
  const double in_floats =
      hf_error(btf, {"bits=float", "clustered=false", "lambda=0.01", "floor=0.001"});
  const double in_bytes = hf_error(btf, {"clustered=false", "lambda=0.01", "floor=0.001"});
  INFO("floats " << in_floats << ", bytes " << in_bytes);
  CHECK(in_floats < 0.01);
  CHECK(in_bytes < 0.02);
}

// A texel that few samples ask for, with small weights, takes a logarithm that exp makes a power
// of.
TEST_CASE("A small lambda does not let texels that few samples ask for swamp their neighbours") {
  const auto btf = realistic_btf(4, "ubo81");
  for (const std::string bits : {"float", "8"}) {
    const auto error = [&](const std::string& lambda) {
      return hf_error(btf, {"levels=false", "clustered=false", "bits=" + bits, "lambda=" + lambda});
    };
    const double smooth = error("1");
    const double steep = error("0.01");
    INFO(bits << ": lambda 1 " << smooth << ", 0.01 " << steep);
    CHECK(steep < 1.1 * smooth);
  }
}

TEST_CASE(
    "lambda = auto is near the best of all lambdas for what is seen, in floats and in 8 bits") {
  const auto btf = realistic_btf(4, "regular:4x8");
  for (const std::string bits : {"float", "8"}) {
    const std::vector<std::string> common{"levels=false", "clustered=false", "bits=" + bits};
    const auto error = [&](const std::string& lambda) {
      std::vector<std::string> parameters = common;
      parameters.push_back("lambda=" + lambda);
      return hf_error(btf, parameters);
    };
    double best = 1e9;
    double worst = 0;
    for (const std::string lambda : {"0.001", "0.01", "0.1", "1", "10"}) {
      best = std::min(best, error(lambda));
      worst = std::max(worst, error(lambda));
    }
    const double found = error("auto");
    INFO(bits << ": auto " << found << ", best " << best << ", worst " << worst);
    CHECK(found < 1.1 * best);
    CHECK(found < 0.9 * worst);
  }
}

TEST_CASE("Maps too steep for their scale end in numbers that can be saved and judged") {
  // Every pair another order of magnitude: the maps follow each, and their product means nothing.
  const auto btf = synthetic_btf(
      2, 2, "ubo81", "ubo81", [](int x, int y, const Direction& l, const Direction& v) {
        const auto at = [](float d) { return static_cast<std::uint64_t>(1e4F * (d + 1)); };
        const float power =
            unit_float(hash_coordinates(x + 2 * y, at(l.x), at(l.y), at(v.x), at(v.y)));
        return Rgb(1, 1, 1) * std::pow(1e-9F, power);
      });
  for (const std::string bits : {"float", "8"}) {
    Progress progress;
    const std::vector<std::string> steep{"refit_scale=false", "lambda=0.0001", "floor=1e-9",
                                         "clustered=false", "bits=" + bits};
    const auto fitted =
        codec_named("hf").fit(btf, Settings::from_text("", "test", steep), progress);
    CHECK(std::isfinite(sample_error(*btf, *fitted).relative_rmse));
    const TemporaryFolder folder;
    fitted->save(folder.path / "steep.hf");
    const Direction up(0, 0, 1);
    CHECK(open_representation(folder.path / "steep.hf")->evaluate({0.3F, 0.6F}, up, up, 0) ==
          fitted->evaluate({0.3F, 0.6F}, up, up, 0));
  }
}

TEST_CASE("lambda = auto fits as the number that it finds does, whatever the threads") {
  const auto btf = realistic_btf(4, "regular:3x6");
  const auto error = [&](const std::string& lambda) {
    return hf_error(btf, {"levels=false", "resolution=9", "lambda=" + lambda});
  };
  const double found = error("auto");
  bool is_a_candidate = false;
  for (int i = 0; i < 13; ++i) {
    is_a_candidate =
        is_a_candidate || error(fmt::format("{:.17g}", std::pow(10.0, -3.0 + 0.5 * i))) == found;
  }
  CHECK(is_a_candidate);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  CHECK(error("auto") == found);
}
