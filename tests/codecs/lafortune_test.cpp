// What is special about `lafortune`: its own lobes come back, Lambert surfaces are exact
// everywhere, what it falls back to is safe and counted, and an interrupted fit continues.

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>

#include "btf/random.h"
#include "codecs/lafortune/lafortune_fit.h"
#include "codecs/lafortune/lafortune_representation.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

std::unique_ptr<Representation> fit(const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters = {}) {
  Progress progress;
  return codec_named("lafortune").fit(btf, Settings::from_text("", "test", parameters), progress);
}

float product(const lafortune::Lobe& lobe, const Direction& l, const Direction& v) {
  return static_cast<float>(lobe.axis[0] * l.x * v.x + lobe.axis[1] * l.y * v.y +
                            lobe.axis[2] * l.z * v.z);
}

}  // namespace

TEST_CASE("Lafortune's lobes and diffuse term come back from values that are made of them") {
  using namespace weft::lafortune;
  const HemisphereSampling sampling(named_directions("ubo81"));
  const PairTable pairs(sampling, sampling);
  const std::vector<Lafortune> truths{
      {2, 0.2, {Lobe{{-1, -1, 0.9}, 0.8, 25}, Lobe{{0.6, 0.7, 1}, 0.5, 4}}},
      {2, 0.05, {Lobe{{-0.9, -1, 1}, 1, 60}, Lobe{{-0.5, -0.5, 1}, 0.4, 3}}},
      {2, 0.4, {Lobe{{-1, -0.95, 0.95}, 0.5, 15}, Lobe{{0.3, 0.4, 1}, 0.3, 2}}}};
  for (const Lafortune& truth : truths) {
    std::vector<double> values(pairs.padded());
    double largest = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Direction& v = sampling[pairs.pair(i) / sampling.size()];
      const Direction& l = sampling[pairs.pair(i) % sampling.size()];
      double f = truth.diffuse;
      for (int k = 0; k < truth.count; ++k)
        f += truth.lobe[k].peak *
             std::pow(std::max(product(truth.lobe[k], l, v), 0.F), truth.lobe[k].exponent);
      values[i] = f * l.z;
      largest = std::max(largest, f);
    }
    for (double& value : values) value /= largest;
    const TexelFit fitted = fit_texel(pairs, values, 2);
    CHECK(!fitted.fell_back);
    const Lafortune& found = fitted.model;
    CHECK(found.diffuse * largest == Approx(truth.diffuse).margin(2e-3));
    // The narrower one first.
    const bool swapped = found.lobe[0].exponent < found.lobe[1].exponent;
    for (int k = 0; k < 2; ++k) {
      const Lobe& a = truth.lobe[k];
      const Lobe& b = found.lobe[swapped ? 1 - k : k];
      CHECK(b.peak * largest == Approx(a.peak).epsilon(0.02));
      CHECK(b.exponent == Approx(a.exponent).epsilon(0.02));
      for (int c = 0; c < 3; ++c) CHECK(b.axis[c] == Approx(a.axis[c]).margin(0.01));
    }
  }
}

TEST_CASE("A Lambert surface is exact with Lafortune, between the samples too") {
  const auto btf = synthetic_btf(2, 2, "ubo81", "regular:2x4",
                                 [](int x, int y, const Direction&, const Direction&) {
                                   return Rgb(0.1F, 0.2F, 0.3F) * static_cast<float>(1 + x + y);
                                 });
  const auto fitted = fit(btf);
  CHECK(sample_error(*btf, *fitted).relative_rmse < 1e-3);
  const Direction light = from_spherical(radians(83.0), radians(17.0));
  const Rgb value =
      fitted->evaluate({0.25F, 0.75F}, light, from_spherical(radians(50.0), radians(99.0)), 0);
  CHECK(value.y / light.z == Approx(0.2).epsilon(2e-3));
}

TEST_CASE("Texels that no start of Lafortune's fits fall back, are counted, and err no more") {
  // A hair beside Lambert: the safe fit is there already when the first steps from the starts end.
  const auto btf = synthetic_btf(
      4, 4, "ubo81", "regular:3x6", [](int x, int y, const Direction& l, const Direction& v) {
        const auto whole = [](float a) { return std::lround(1e4F * a); };
        const double noise =
            unit_float(hash_coordinates(x, y, whole(l.x), whole(l.y), whole(v.x), whole(v.y))) -
            0.5;
        return Rgb(static_cast<float>(0.5 + 1e-5 * noise));
      });
  Progress progress;
  const auto fitted = codec_named("lafortune").fit(btf, Settings(), progress);
  const double count = progress.reported().at("texels_that_fell_back");
  CHECK(count > 0);
  CHECK(count <= 16);
  CHECK(sample_error(*btf, *fitted).relative_rmse < 1e-3);
}

TEST_CASE("A Lafortune fit of values that are no numbers falls back to what is finite") {
  using namespace weft::lafortune;
  const HemisphereSampling sampling(named_directions("regular:3x6"));
  const PairTable pairs(sampling, sampling);
  std::vector<double> values(pairs.padded());
  for (std::size_t i = 0; i < pairs.size(); ++i) values[i] = 0.5 * pairs.cosine()[i];
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    values[7] = bad;
    const TexelFit found = fit_texel(pairs, values, 2);
    CHECK(found.fell_back);
    CHECK(found.model.diffuse == 0);
    for (const Lobe& lobe : found.model.lobe) CHECK(lobe.peak == 0);
  }
}

TEST_CASE("An interrupted fit of Lafortune models continues with the rows that it has") {
  const auto btf = realistic_btf(3, "regular:3x6");
  const auto texels_of = [](const Representation& representation) {
    return dynamic_cast<const lafortune::LafortuneRepresentation&>(representation).model().texels;
  };
  const std::vector<float> whole = texels_of(*fit(btf));
  const TemporaryFolder folder;
  const auto run = [&](double expected) {
    Progress progress;
    progress.keep_in(folder.path / "a.partial");
    const auto fitted = codec_named("lafortune").fit(btf, Settings(), progress);
    CHECK(progress.reported().at("pieces_kept") == expected);
    return texels_of(*fitted);
  };
  CHECK(run(0) == whole);
  CHECK(std::filesystem::remove(folder.path / "a.partial" / "row_0001.f64"));
  CHECK(run(2) == whole);
}

TEST_CASE("One Lafortune model errs more than lobes or polynomials a view") {
  const auto btf = realistic_btf(4, "ubo81");
  Progress progress;
  const auto error = [&](const std::string& codec) {
    return sample_error(*btf, *codec_named(codec).fit(btf, Settings(), progress))
        .luminance_difference;
  };
  const double ptm = error("ptm");
  CHECK(error("lobes") < ptm);
  CHECK(ptm < error("lafortune"));
}
