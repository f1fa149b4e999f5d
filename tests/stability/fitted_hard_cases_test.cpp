// Reflectances that lobes are hard to fit to: a mirror's peak, black, one sample, a light at 90
// degrees, exponents at their bounds.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "codecs/lobes/lobe_fit.h"
#include "codecs/reflectance_fields/representation.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"

using namespace weft;

namespace {

/// B of light and view.
using Formula = std::function<float(const Direction& light, const Direction& view)>;

std::shared_ptr<const Btf> btf_of(std::vector<Direction> lights, const Formula& b) {
  Btf btf(2, 1, HemisphereSampling(named_directions("ubo81")),
          HemisphereSampling(std::move(lights)), PixelType::float32);
  for (std::size_t v = 0; v < btf.views().size(); ++v) {
    for (std::size_t l = 0; l < btf.lights().size(); ++l) {
      const float value = b(btf.lights()[l], btf.views()[v]);
      for (int x = 0; x < 2; ++x) btf.set(l, v, x, 0, Rgb(value));
    }
  }
  return std::make_shared<const Btf>(std::move(btf));
}

std::unique_ptr<Representation> fitted(const std::shared_ptr<const Btf>& btf,
                                       const std::string& codec = "lobes") {
  Progress silent;
  return codec_named(codec).fit(btf, Settings(), silent);
}

// Between the samples, over all directions.
float largest_answer(const Representation& representation) {
  float largest = 0;
  for (int i = 0; i < 40; ++i) {
    const Direction view = from_spherical(radians(89 * std::fmod(0.618 * i, 1.0)),
                                          radians(360 * std::fmod(0.755 * i, 1.0)));
    for (int j = 0; j < 2000; ++j) {
      const Direction light = from_spherical(radians(90 * std::fmod(0.618 * j, 1.0)),
                                             radians(360 * std::fmod(0.414 * j, 1.0)));
      const Rgb value = representation.evaluate({0.25F, 0.5F}, light, view, 0);
      REQUIRE(std::isfinite(value.x));
      REQUIRE(value.x >= 0);
      largest = std::max(largest, value.x);
    }
  }
  return largest;
}

double relative_error(const std::shared_ptr<const Btf>& btf) {
  return sample_error(*btf, *fitted(btf)).relative_rmse;
}

}  // namespace

TEST_CASE("Lobes bear a mirror's peak: seen at one sample, bounded between") {
  const auto mirror = [](const Direction& l, const Direction& v) {
    const Direction reflected(-v.x, -v.y, v.z);
    return (l ^ reflected) > 0.999F ? 100.F : 0.F;
  };
  const auto btf = btf_of(named_directions("ubo81"), mirror);
  CHECK(relative_error(btf) < 0.03);
  const float largest = largest_answer(*fitted(btf));
  CHECK(largest <= 121);  // 1.2 times, rounded
  CHECK(largest > 20);
  // With a floor beside it, which the second lobe takes.
  const auto with_floor = btf_of(named_directions("ubo81"), [&](const auto& l, const auto& v) {
    return mirror(l, v) + 0.3F * l.z;
  });
  CHECK(relative_error(with_floor) < 0.03);
}

TEST_CASE("Lobes bear a mirror's peak between the samples, wherever it falls") {
  for (const float exponent : {50.F, 400.F, 5000.F}) {
    const auto btf = btf_of(named_directions("ubo81"), [&](const auto& l, const auto& v) {
      const Direction reflected(-v.x, -v.y, v.z);
      const Direction away = (reflected + Direction(0.07F, -0.05F, 0)).normalized();
      return std::pow(std::max(l ^ away, 0.F), exponent);
    });
    float largest = 0;
    for (std::size_t v = 0; v < 81; ++v) {
      for (std::size_t l = 0; l < 81; ++l) largest = std::max(largest, btf->at(l, v, 0, 0).x);
    }
    for (const std::string codec : {"lobes", "lafortune"})
      CHECK(largest_answer(*fitted(btf, codec)) <= 3 * largest);
  }
}

TEST_CASE("Lobes bear all black: black everywhere, and nothing fell back") {
  const auto btf = btf_of(named_directions("ubo81"), [](const auto&, const auto&) { return 0.F; });
  for (const std::string codec : {"lobes", "ptm", "lafortune"}) {
    Progress progress;
    const auto representation = codec_named(codec).fit(btf, Settings(), progress);
    CHECK(largest_answer(*representation) == 0);
    for (const auto& [name, count] : progress.reported()) CHECK(count == 0);
  }
}

TEST_CASE("Lobes bear one sample: one light, near the zenith and at a grazing angle") {
  for (const double theta : {0.0, 40.0, 85.0}) {
    const Direction light = from_spherical(radians(theta), radians(30.0));
    const auto btf = btf_of({light}, [](const auto& l, const auto&) { return 0.5F * l.z; });
    CHECK(relative_error(btf) < 1e-3);
    for (const std::string codec : {"lobes", "ptm", "lafortune"}) {
      INFO(codec << " " << theta);
      const auto representation = fitted(btf, codec);
      CHECK(sample_error(*btf, *representation).relative_rmse < 1e-3);
      CHECK(largest_answer(*representation) <= 1.21F * 0.5F);
    }
  }
}

TEST_CASE("Lobes bear a light at 90 degrees: it says nothing, and the rest is fitted as without") {
  std::vector<Direction> lights = named_directions("ubo81");
  const auto b = [](const Direction& l, const Direction& v) {
    return l.z > 0 ? 0.3F * l.z + 0.2F * std::pow(std::max(l ^ v, 0.F), 6.F) : 1000.F;
  };
  const auto without = fitted(btf_of(lights, b));
  lights.emplace_back(1.F, 0.F, 0.F);
  lights.emplace_back(0.F, -1.F, 0.F);
  const auto with = btf_of(lights, b);
  CHECK(relative_error(with) < 0.03);
  CHECK(largest_answer(*fitted(with)) <= 1.05F * largest_answer(*without));
  // Lights on the horizon alone.
  const auto only = btf_of({Direction(1, 0, 0), Direction(0, 1, 0)},
                           [](const auto&, const auto&) { return 1.F; });
  for (const std::string codec : {"lobes", "ptm", "lafortune"})
    CHECK(largest_answer(*fitted(only, codec)) == 0);
}

TEST_CASE("Lobes bear exponents at their bounds: a step and a needle stay finite and near") {
  using namespace weft::lobes;
  const auto needle = [](const Direction& l, const Direction& v) {
    return std::pow(std::max(l ^ v, 0.F), 5000.F);
  };
  const auto step = [](const Direction& l, const Direction& v) { return l.x > v.x ? 1.F : 0.F; };
  for (const auto& [b, tolerance, bound] :
       {std::tuple<Formula, double, double>{needle, 0.03, largest_exponent},
        {step, 0.35, least_exponent}}) {
    const auto btf = btf_of(named_directions("ubo81"), b);
    Progress progress;
    const auto representation = codec_named("lobes").fit(btf, Settings(), progress);
    CHECK(sample_error(*btf, *representation).relative_rmse < tolerance);
    CHECK(largest_answer(*representation) <= 2 * 1.21F);
    const auto& model =
        dynamic_cast<const reflectance_fields::FieldRepresentation&>(*representation).model();
    double at_bound = 0;
    for (std::size_t i = 3; i < model.fields.size(); i += 4)
      at_bound += (i % 12 != 11 && model.fields[i] == bound) ? 1 : 0;
    CHECK(at_bound > 0);
  }
}
