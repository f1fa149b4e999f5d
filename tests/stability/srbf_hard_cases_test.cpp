// Data and kernels at the edge of what the SRBF codec can be given.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "codecs/srbf/kernels.h"
#include "codecs/srbf/objective.h"
#include "codecs/srbf/srbf_representation.h"

using namespace weft;
using namespace weft::srbf;

namespace {

using Formula = std::function<float(const Direction& light, const Direction& view)>;

std::shared_ptr<const Btf> btf_of(const std::vector<Direction>& lights,
                                  const std::vector<Direction>& views, const Formula& b) {
  auto btf = std::make_shared<Btf>(1, 1, HemisphereSampling(views), HemisphereSampling(lights),
                                   PixelType::float32);
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (std::size_t l = 0; l < lights.size(); ++l)
      btf->set(l, v, 0, 0, Rgb(b(lights[l], views[v])));
  }
  return btf;
}

double fitted_error(const Btf& btf, const Representation& fit, float largest) {
  for (const Direction& light : named_directions("fibonacci:37")) {
    for (const Direction& view : named_directions("fibonacci:41")) {
      const Rgb value = fit.evaluate({0.5F, 0.5F}, light, view, 0);
      for (int c = 0; c < 3; ++c) {
        REQUIRE(std::isfinite(value[c]));
        REQUIRE(value[c] >= 0);
        REQUIRE(value[c] <= 4 * largest);
      }
    }
  }
  return sample_error(btf, fit).relative_rmse;
}

double error_of(const std::shared_ptr<const Btf>& btf, float largest,
                const std::vector<std::string>& parameters = {}) {
  Progress silent;
  const auto fit =
      codec_named("srbf").fit(btf, Settings::from_text("", "test", parameters), silent);
  return fitted_error(*btf, *fit, largest);
}

/// A model of one texel, kernels as given.
SrbfRepresentation of(const Kernels& kernels) {
  const std::vector<Direction> up = {Direction(0, 0, 1)};
  Model model{.head = {.width = 1,
                       .height = 1,
                       .views = HemisphereSampling(up),
                       .lights = HemisphereSampling(up)}};
  model.storage = Storage::float32;
  model.shape = kernels.shape();
  model.set_kernels({kernels}, 1);
  return SrbfRepresentation(std::move(model));
}

void check_gradient_is_finite(Kernels kernels, const std::vector<Direction>& directions) {
  const auto btf = btf_of(directions, directions, [](const Direction& l, const Direction& v) {
    return 0.3F + l.x * v.y * 0.2F;
  });
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  std::vector<float> abrdf(3 * samples.pairs);
  btf->abrdf(0, 0, abrdf);
  const std::vector<float> texel = channel_arrays(samples, abrdf, 1);
  Objective objective(samples, kernels.shape(), Ridge{});
  objective.set_texel(texel);
  std::vector<double> gradient(kernels.shape().unknowns());
  CHECK(std::isfinite(objective(kernels, gradient, true).total));
  for (const double g : gradient) CHECK(std::isfinite(g));
}

}  // namespace

TEST_CASE("SRBF bears a mirror's peak") {
  const auto directions = named_directions("ubo81");
  const auto mirror = [](const Direction& l, const Direction& v) {
    const Direction half = (l + v).normalized();
    return 0.02F + 50 * std::pow(std::max(half.z, 0.0F), 2000.0F);
  };
  CHECK(error_of(btf_of(directions, directions, mirror), 50) < 0.25);
}

TEST_CASE("SRBF bears black data and a single sample") {
  const auto directions = named_directions("regular:3x6");
  const auto black = [](const Direction&, const Direction&) { return 0.0F; };
  const auto grey = [](const Direction&, const Direction&) { return 0.25F; };
  const std::vector<Direction> one = {from_spherical(0.7, 2)};
  CHECK(error_of(btf_of(directions, directions, black), 0) == 0);
  CHECK(error_of(btf_of(one, one, grey), 0.25F) < 0.004);
  CHECK(error_of(btf_of(one, one, black), 0) == 0);
  for (const char* modes : {"half-half-half", "half-difference", "half-light-view", "in-out"})
    CHECK(error_of(btf_of(one, one, grey), 0.25F, {std::string("modes=") + modes}) < 0.004);
}

TEST_CASE("SRBF bears lights and views at 90 degrees, which tell nothing") {
  std::vector<Direction> directions = named_directions("regular:3x6");
  directions.emplace_back(1.0F, 0.0F, 0.0F);
  directions.emplace_back(0.0F, 1.0F, 0.0F);
  const auto lambert = [](const Direction& l, const Direction&) { return 0.3F * l.z; };
  CHECK(error_of(btf_of(directions, directions, lambert), 0.3F) < 0.02);
  CHECK(error_of(btf_of(directions, directions, lambert), 0.3F, {"quantity=f"}) < 0.004);
}

TEST_CASE("SRBF bears centres at antipodes, of any bandwidth") {
  const Direction light = from_spherical(0.5, 1);
  const Direction view = from_spherical(1.1, 3);
  for (const double lambda : {0.0, 1.0, 40.0, 1e4, 1e8}) {
    Kernels kernels({4, 1});
    kernels.angles()[0] = std::numbers::pi / 4;
    const Direction variable = psi(kernels.angles()[0], light, view);
    for (std::size_t j = 0; j < 4; ++j) {
      for (int c = 0; c < 3; ++c)
        kernels.centre(j, 0)[c] = lambda * variable[c] * (j % 2 == 0 ? 1 : -1);
      for (std::size_t c = 0; c < 3; ++c) kernels.colours()[3 * j + c] = 1;
    }
    const float found = of(kernels).evaluate({0.5F, 0.5F}, light, view, 0).x;
    // The antipodes are e^(-2 lambda).
    CHECK(found >= (lambda < 1e3 ? 1.9F : 0.0F));
    CHECK(found <= 4.01F);
    check_gradient_is_finite(kernels, named_directions("regular:3x6"));
  }
}

TEST_CASE("SRBF bears modes in which light and view cancel, a psi of no length") {
  Kernels kernels({4, 2});
  kernels.angles()[0] = -std::numbers::pi / 4;
  kernels.angles()[1] = 3 * std::numbers::pi / 4;
  for (std::size_t i = 0; i < kernels.shape().centres(); ++i)
    kernels.values()[i] = i % 3 == 0 ? 5 : -2;
  std::ranges::fill(kernels.colours(), 0.5);
  const auto directions = named_directions("regular:3x6");
  const SrbfRepresentation fit = of(kernels);
  for (const Direction& d : directions) {
    const float found = fit.evaluate({0.5F, 0.5F}, d, d, 0).x;
    CHECK(found == Approx(evaluate(kernels, d, d)[0]).epsilon(1e-3));
    CHECK(found <= 2.0F);
  }
  check_gradient_is_finite(kernels, directions);
  check_gradient_is_finite(kernels, {Direction(0, 0, 1)});
}
