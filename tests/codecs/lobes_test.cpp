// What is special about `lobes`: lobes come back from data made of them, peaks and exponents are
// bounded, what is behind a lobe is dark, and an interrupted fit continues.

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "btf/atomic_file.h"
#include "btf/random.h"
#include "codecs/fit_checkpoint.h"
#include "codecs/lobes/fit.h"
#include "codecs/lobes/lobe_starts.h"
#include "codecs/reflectance_fields/representation.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/temporary_folder.h"

using namespace weft;
using namespace weft::lobes;

namespace {

std::unique_ptr<Representation> fit(const std::string& codec, const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters = {}) {
  Progress progress;
  return codec_named(codec).fit(btf, Settings::from_text("", "test", parameters), progress);
}

double unit(std::uint64_t index, int dimension) {
  return unit_float(hash_coordinates(29, index, dimension));
}

double angle(const Lobe& a, const Lobe& b) {
  double cosine = 0;
  for (int c = 0; c < 3; ++c) cosine += a.axis[c] * b.axis[c];
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

Lobe random_lobe(std::uint64_t index, int first) {
  const Direction d =
      from_spherical(radians(65 * unit(index, first)), radians(360 * unit(index, first + 1)));
  return {{d.x, d.y, d.z},
          0.2 + 0.8 * unit(index, first + 2),
          1.5 * std::pow(25.0, unit(index, first + 3))};
}

LobeSum random_lobes(std::uint64_t index) {
  LobeSum lobes;
  lobes.count = 2;
  for (int attempt = 0; attempt == 0 || angle(lobes.lobe[0], lobes.lobe[1]) < radians(40.0);
       attempt += 8) {
    lobes.lobe[0] = random_lobe(index, attempt);
    lobes.lobe[1] = random_lobe(index, attempt + 4);
  }
  return lobes;
}

// The values of a sum, and the sum itself, both over the largest value.
std::vector<double> normalised_values(const LightTable& lights, LobeSum& lobes) {
  std::vector<double> values(lights.padded());
  evaluate(lights, lobes, values);
  const double largest = *std::ranges::max_element(values);
  for (double& value : values) value /= largest;
  for (Lobe& lobe : lobes.lobe) lobe.peak /= largest;
  return values;
}

const reflectance_fields::Model& model_of(const Representation& representation) {
  return dynamic_cast<const reflectance_fields::FieldRepresentation&>(representation).model();
}

// A texel and view of one lobe, white, as it is stored.
std::unique_ptr<Representation> one_lobe(const Direction& axis, float peak, float exponent) {
  const Btf btf(1, 1, HemisphereSampling(named_directions("fibonacci:1")),
                HemisphereSampling(named_directions("ubo81")), PixelType::half);
  auto model = reflectance_fields::empty_model(btf, "lobes", reflectance_fields::Kind::lobes, 1,
                                               Storage::half, "{}");
  model.fields = {axis.x * peak, axis.y * peak, axis.z * peak, exponent, 1, 1, 1, 0};
  reflectance_fields::store_fields(model);
  return std::make_unique<reflectance_fields::FieldRepresentation>(std::move(model));
}

}  // namespace

TEST_CASE("Two lobes come back from values that are made of them") {
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  int tried = 0;
  int recovered = 0;
  constexpr int cases = 60;
  for (std::uint64_t i = 0; i < cases; ++i) {
    LobeSum truth = random_lobes(i);
    const std::vector<double> values = normalised_values(lights, truth);
    // A narrow lobe between the lights may be higher than a fit makes any.
    if (truth.lobe[0].peak > largest_peak || truth.lobe[1].peak > largest_peak) continue;
    ++tried;
    const FieldFit found = fit_field(lights, values, 2);
    const bool swapped =
        angle(found.lobes.lobe[0], truth.lobe[0]) > angle(found.lobes.lobe[1], truth.lobe[0]);
    bool is_near = !found.fell_back;
    for (int k = 0; k < 2; ++k) {
      const Lobe& a = truth.lobe[k];
      const Lobe& b = found.lobes.lobe[swapped ? 1 - k : k];
      is_near = is_near && angle(a, b) < 1e-3 && std::abs(a.peak - b.peak) < 1e-3 &&
                std::abs(a.exponent / b.exponent - 1) < 5e-3;
    }
    recovered += is_near ? 1 : 0;
  }
  CHECK(tried > 0.8 * cases);
  CHECK(recovered == tried);
}

namespace {

// By how much a neighbour of the lobes errs less than they do, of their own error; 0 where none
// does.
double gain_nearby(const LightTable& lights, std::span<const double> values, const LobeSum& lobes) {
  const double error = squared_error(lights, values, lobes);
  double least = error;
  const auto try_other = [&](const LobeSum& other) {
    least = std::min(least, squared_error(lights, values, other));
  };
  for (int k = 0; k < lobes.count; ++k) {
    for (const double step : {-1e-3, -1e-4, 1e-4, 1e-3}) {
      LobeSum other = lobes;
      other.lobe[k].peak = std::clamp(other.lobe[k].peak + step, 0.0, largest_peak);
      try_other(other);
      other = lobes;
      other.lobe[k].exponent =
          std::clamp(other.lobe[k].exponent * (1 + step), least_exponent, largest_exponent);
      try_other(other);
      for (int c = 0; c < 3; ++c) {
        other = lobes;
        auto& axis = other.lobe[k].axis;
        axis[c] += step;
        const double length = std::hypot(axis[0], axis[1], axis[2]);
        for (double& a : axis) a /= length;
        try_other(other);
      }
    }
  }
  return 1 - least / error;
}

constexpr FitLimits until_the_end{.iterations = 500, .tolerance = 1e-12};

}  // namespace

TEST_CASE("The derivatives lead to the least squares: no neighbour of the fit errs less") {
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  LobeSum data = random_lobes(5);
  data.count = 4;
  data.lobe[2] = random_lobe(6, 0);
  data.lobe[3] = {{0, 0, 1}, 0.5, 1};
  const std::vector<double> values = normalised_values(lights, data);
  LobeSum fitted = random_lobes(3);
  fit_peaks(lights, values, fitted);
  const double begun = squared_error(lights, values, fitted);
  const double error = improve(lights, values, until_the_end, fitted);
  CHECK(error < begun);
  CHECK(error == Approx(squared_error(lights, values, fitted)));
  CHECK(gain_nearby(lights, values, fitted) < 1e-6);
}

TEST_CASE("On noise too: where a lobe's edge stops the fit, little is left to gain") {
  // The sum has a kink where a light comes before a lobe, and the least may lie in one.
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  for (std::uint64_t i = 0; i < 60; ++i) {
    LobeSum data = random_lobes(i);
    std::vector<double> values = normalised_values(lights, data);
    const double noise = std::array{0.02, 0.2, 1.0}[i % 3];
    for (std::size_t l = 0; l < lights.size(); ++l)
      values[l] = std::clamp(values[l] + noise * (unit(i, static_cast<int>(l)) - 0.5), 0.0, 1.0);
    LobeSum fitted = random_lobes(i + 100);
    fit_peaks(lights, values, fitted);
    improve(lights, values, until_the_end, fitted);
    CHECK(gain_nearby(lights, values, fitted) < 5e-4);
  }
}

TEST_CASE("Peaks are at most 1.2 times the largest sample, exponents within bounds, on any data") {
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  for (std::uint64_t i = 0; i < 200; ++i) {
    // From one bright sample in twenty to all.
    std::vector<double> values(lights.padded());
    const double share = 0.05 * static_cast<double>(1 + i % 20);
    for (std::size_t l = 0; l < lights.size(); ++l)
      values[l] = unit(i, static_cast<int>(l)) < share ? unit(i, static_cast<int>(l) + 500) : 0;
    const double largest = *std::ranges::max_element(values);
    if (!(largest > 0)) continue;
    for (double& value : values) value /= largest;
    const FieldFit found = fit_field(lights, values, 3);
    for (int k = 0; k < 3; ++k) {
      CHECK(found.lobes.lobe[k].peak >= 0);
      CHECK(found.lobes.lobe[k].peak <= largest_peak);
      CHECK(found.lobes.lobe[k].exponent >= least_exponent);
      CHECK(found.lobes.lobe[k].exponent <= largest_exponent);
    }
  }
}

namespace {

// Luminance of a facet that is tilted from the normal, with a highlight, dark towards grazing
// lights, which its surroundings shadow.
struct Facet {
  double tilt;
  double gloss;     // exponent of the highlight
  double strength;  // of the highlight
  double shadow;    // cosine of the light at which half is left; below 0 none
};

double luminance(const Facet& facet, const Direction& light) {
  const Direction normal = from_spherical(radians(facet.tilt), radians(20.0));
  const Direction view = from_spherical(radians(30.0), radians(200.0));
  const double cosine = normal ^ light;
  if (!(cosine > 0)) return 0;
  const double half = std::max((light + view).normalized() ^ normal, 0.0F);
  const double lit = facet.shadow < 0 ? 1 : 1 / (1 + std::exp(-8 * (light.z - facet.shadow)));
  return (cosine + facet.strength * std::pow(half, facet.gloss)) * lit;
}

}  // namespace

TEST_CASE("Two lobes fit the value with its cosine better than the value without, times it") {
  // What is left of the value without its cosine grows without bound where a facet faces a grazing
  // light.
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  for (const Facet& facet : {Facet{30, 1, 0, 0.2}, Facet{50, 20, 0.5, -1}}) {
    std::vector<double> value(lights.padded());
    std::vector<double> without(lights.padded());
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const auto l = lights.direction(i);
      value[i] = luminance(facet, {(float)l[0], (float)l[1], (float)l[2]});
      without[i] = value[i] / l[2];
    }
    const double largest_value = *std::ranges::max_element(value);
    const double largest_without = *std::ranges::max_element(without);
    for (double& v : value) v /= largest_value;
    for (double& v : without) v /= largest_without;
    const FieldFit direct = fit_field(lights, value, 2);
    std::vector<double> detour(lights.padded());
    evaluate(lights, fit_field(lights, without, 2).lobes, detour);
    double error = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      const double found = detour[i] * lights.direction(i)[2] * largest_without / largest_value;
      error += std::pow(found - value[i], 2);
    }
    INFO("tilt " << facet.tilt << ": " << std::sqrt(direct.error) << " and " << std::sqrt(error));
    CHECK(std::sqrt(direct.error) < 0.6 * std::sqrt(error));
  }
}

TEST_CASE("The high-pass finds the peaks of a field, the sharper first") {
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  std::vector<double> values(lights.padded());
  // The larger value is the less sharp one.
  for (std::size_t i = 0; i < lights.size(); ++i) values[i] = lights.direction(i)[2];
  values[20] += 0.5;
  values[60] += 0.7;
  CHECK(principal_lights(lights, values, 2) == std::vector<std::size_t>{60, 20});
}

TEST_CASE("Behind a lobe there is nothing: below zero, the scalar product is zero") {
  const auto lobe = one_lobe(Direction(0.8F, 0, 0.6F), 1, 3);
  const Direction up(0, 0, 1);
  // Exponents are whole here: a power of the negative product would be a number below zero.
  for (const double theta : {38.0, 60.0, 89.0}) {
    const Direction behind = from_spherical(radians(theta), radians(180.0));
    CHECK(lobe->evaluate({0.5F, 0.5F}, behind, up, 0) == Rgb(0, 0, 0));
  }
  const Direction before = from_spherical(radians(50.0), 0);
  CHECK(lobe->evaluate({0.5F, 0.5F}, before, up, 0).y ==
        Approx(std::pow(Direction(0.8F, 0, 0.6F) ^ before, 3)).epsilon(2e-3));
}

TEST_CASE("Narrow lobes keep their height in halfs") {
  for (const float exponent : {1.F, 30.F, 200.F, 512.F}) {
    const Direction axis = from_spherical(radians(33.0), radians(71.0));
    const auto lobe = one_lobe(axis, 0.7F, exponent);
    CHECK(lobe->evaluate({0.5F, 0.5F}, axis, Direction(0, 0, 1), 0).x == Approx(0.7).epsilon(1e-3));
  }
}

TEST_CASE("Halfs never overflow: whatever the data, and in the middle of a decoder too") {
  // Values up to what a float holds, a range of 1e12, one channel alone.
  for (const float largest : {1e-6F, 1.F, 65504.F, 1e12F, 1e30F}) {
    const auto btf = synthetic_btf(
        2, 2, "ubo81", "regular:2x3", [&](int x, int y, const Direction& l, const Direction&) {
          const float sharp = std::pow(std::max(l.x, 0.F), 40.F);
          return x == 0 ? Rgb(0, 0, largest * sharp) : Rgb(largest * 1e-12F * (1 + (float)y));
        });
    for (const std::string count : {"1", "4"}) {
      const auto fitted = fit("lobes", btf, {"lobes=" + count});
      const reflectance_fields::Model& model = model_of(*fitted);
      const std::size_t stride = model.floats_a_field();
      const float half_max = std::numeric_limits<half>::max();
      for (std::size_t field = 0; field < model.fields.size(); field += stride) {
        float sum_of_peaks = 0;
        for (std::size_t k = 0; k < model.lobes; ++k) {
          const float* w = &model.fields[field + 4 * k];
          const float peak = std::hypot(w[0], w[1], w[2]);
          CHECK(peak <= 1.2F * 1.001F);  // rounded
          CHECK(w[3] >= 1);
          CHECK(w[3] <= 512);
          sum_of_peaks += peak;
        }
        for (int c = 0; c < 3; ++c) {
          const float colour = model.fields[field + stride - 4 + c];
          CHECK(std::isfinite(colour));
          CHECK(colour * sum_of_peaks < half_max);
        }
      }
      for (int i = 0; i < 500; ++i) {
        const auto theta = radians(90 * unit(i, 0));
        const Rgb value =
            fitted->evaluate({static_cast<float>(unit(i, 2)), static_cast<float>(unit(i, 3))},
                             from_spherical(theta, radians(360 * unit(i, 1))),
                             from_spherical(radians(89 * unit(i, 4)), 0), 0);
        for (int c = 0; c < 3; ++c) {
          CHECK(value[c] >= 0);
          CHECK(value[c] <= 1.3F * 4 * largest);
        }
      }
    }
  }
}

TEST_CASE("Lobes err less than polynomials, and more lobes less") {
  const auto btf = realistic_btf(4, "ubo81");
  const auto error = [&](const std::string& codec, const std::vector<std::string>& parameters) {
    return sample_error(*btf, *fit(codec, btf, parameters)).luminance_difference;
  };
  const double two = error("lobes", {});
  CHECK(two < 0.5 * error("ptm", {}));
  CHECK(two < 0.5 * error("ptm", {"cosine=inside"}));
  CHECK(two < error("lobes", {"lobes=1"}));
  CHECK(error("lobes", {"lobes=3"}) < two);
}

TEST_CASE("An interrupted fit of lobes continues with the views that it has, to the same bytes") {
  const auto btf = realistic_btf(3, "regular:2x4");
  const auto whole = model_of(*fit("lobes", btf)).fields;
  const TemporaryFolder folder;
  const auto partial = folder.path / "a.partial";
  const auto run = [&] {
    Progress progress;
    progress.keep_in(partial);
    return lobes::fit(*btf, {}, progress).fields;
  };
  CHECK(run() == whole);
  for (const char* view : {"view_004.f64", "view_007.f64"})
    CHECK(std::filesystem::remove(partial / view));
  CHECK(run() == whole);
  // Rounding comes later: the pieces serve floats too.
  Progress of_floats;
  of_floats.keep_in(partial);
  lobes::fit(*btf, {.storage = Storage::float32}, of_floats);
  CHECK(of_floats.reported().at("pieces_kept") == static_cast<double>(btf->views().size()));
  // What is kept is what is taken: black views stay so.
  const FitCheckpoint kept(partial, read_text(partial / "checkpoint.json"));
  const std::size_t numbers = whole.size() / btf->views().size() + 6;
  CHECK(kept.find("view_002", numbers).has_value());
  kept.keep("view_002", std::vector<double>(numbers));
  const auto changed = run();
  const std::size_t a_view = whole.size() / btf->views().size();
  for (std::size_t i = 0; i < a_view; ++i) CHECK(changed[2 * a_view + i] == 0);
  CHECK(std::equal(whole.begin(), whole.begin() + 2 * a_view, changed.begin()));
}

TEST_CASE(
    "A field that no start of lobes fits falls back to a cosine, which is finite and counted") {
  const LightTable lights(HemisphereSampling(named_directions("ubo81")));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    std::vector<double> values(lights.padded());
    for (std::size_t i = 0; i < lights.size(); ++i) values[i] = lights.direction(i)[2];
    CHECK(!fit_field(lights, values, 2).fell_back);
    values[40] = bad;
    const FieldFit found = fit_field(lights, values, 2);
    CHECK(found.fell_back);
    CHECK(found.lobes.count == 2);
    for (const Lobe& lobe : found.lobes.lobe) CHECK(lobe.peak == 0);
  }
}

TEST_CASE("A fit of lobes reports what fell back and what stands at a bound") {
  Progress progress;
  const auto btf = realistic_btf(3, "regular:2x4");
  lobes::fit(*btf, {}, progress);
  const auto told = progress.reported();
  for (const char* name : {"fields_that_fell_back", "lobes_at_least_exponent",
                           "lobes_at_largest_exponent", "lobes_at_largest_peak"})
    CHECK(told.contains(name));
}
