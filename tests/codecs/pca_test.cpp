// What is special about the PCA codecs: linear data come back, and more components err less.

#include <catch2/catch.hpp>
#include <cmath>

#include "btf/raw_appearance.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

std::unique_ptr<Representation> fit(const std::string& codec, const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters) {
  Progress progress;
  return codec_named(codec).fit(btf, Settings::from_text("", "test", parameters), progress);
}

std::vector<AppearanceQuery> queries() {
  std::vector<AppearanceQuery> queries;
  for (int i = 0; i < 1000; ++i) {
    const auto angle = [&](double a, double top) { return std::fmod(a * (i + 1), 1.0) * top; };
    queries.push_back(
        {Texcoord(static_cast<float>(angle(0.618, 4)) - 2, static_cast<float>(angle(0.755, 4)) - 2),
         from_spherical(angle(0.414, radians(89.0)), angle(0.303, radians(360.0))),
         from_spherical(angle(0.732, radians(89.0)), angle(0.236, radians(360.0))), 0});
  }
  return queries;
}

float worst_difference(const Appearance& a, const Appearance& b) {
  float worst = 0;
  for (const AppearanceQuery& q : queries()) {
    const Rgb difference =
        a.evaluate(q.uv, q.light, q.view, 0) - b.evaluate(q.uv, q.light, q.view, 0);
    worst =
        std::max({worst, std::abs(difference.x), std::abs(difference.y), std::abs(difference.z)});
  }
  return worst;
}

}  // namespace

TEST_CASE(
    "With as many components as there are texels, PCA is the raw BTF between the samples too") {
  const auto btf = realistic_btf(4, "regular:3x6");
  const RawAppearance raw(btf);
  CHECK(worst_difference(*fit("pca", btf, {"components=16", "bits=float"}), raw) < 1e-5F);
  CHECK(worst_difference(*fit("pca-view", btf, {"components=16", "bits=float"}), raw) < 1e-5F);
}

TEST_CASE("PCA errs less with more components, and pca-view less than pca at as many") {
  const auto btf = realistic_btf(12, "regular:3x6");
  double before = 1;
  for (const std::string n : {"1", "4", "12"}) {
    const double whole = sample_error(*btf, *fit("pca", btf, {"components=" + n})).relative_rmse;
    const double by_view =
        sample_error(*btf, *fit("pca-view", btf, {"components=" + n})).relative_rmse;
    CHECK(whole < 0.8 * before);
    CHECK(by_view < whole);
    before = whole;
  }
}

TEST_CASE("PCA: halfs add less than 1 percent to the error, 8 bits less than 10") {
  const auto btf = realistic_btf(8, "regular:4x8");
  for (const std::string codec : {"pca", "pca-view"}) {
    const auto error = [&](const std::string& bits) {
      return sample_error(*btf, *fit(codec, btf, {"components=6", "bits=" + bits})).rmse;
    };
    const double in_floats = error("float");
    INFO(codec << ": float " << in_floats << ", half " << error("half") << ", 8 " << error("8"));
    CHECK(error("half") < 1.01 * in_floats);
    CHECK(error("8") < 1.1 * in_floats);
  }
}

TEST_CASE("PCA batched answers as one by one, any number of queries") {
  const auto btf = realistic_btf(5, "ubo81");
  for (const std::string codec : {"pca", "pca-view"}) {
    const auto fitted = fit(codec, btf, {"components=9"});
    for (const std::size_t count : {1, 15, 16, 33}) {
      const std::vector<AppearanceQuery> asked = queries();
      std::vector<Rgb> answers(count);
      fitted->evaluate(std::span(asked).first(count), answers);
      for (std::size_t i = 0; i < count; ++i) {
        const AppearanceQuery& q = asked[i];
        CHECK((answers[i] - fitted->evaluate(q.uv, q.light, q.view, 0)).length() < 1e-5F);
      }
    }
  }
}
