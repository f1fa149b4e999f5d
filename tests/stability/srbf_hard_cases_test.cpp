// Data and kernels at the edge of what the SRBF codec can be given.

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "acquisition/acquire.h"
#include "btf/vector.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "codecs/srbf/kernels.h"
#include "codecs/srbf/objective.h"
#include "codecs/srbf/srbf_representation.h"
#include "codecs/srbf/texel_fit.h"
#include "tests/acquisition/mesostructure_files.h"

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
        // Nothing holds kernels between the samples: 3 to 5 times were seen, by the build's
        // rounding.
        REQUIRE(value[c] <= 10 * largest);
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

TEST_CASE("SRBF fits from centres at antipodes of all that is bright") {
  const auto directions = named_directions("regular:3x8");
  const Direction peak = from_spherical(0.5, 1);
  const auto lobe = [&](const Direction& l, const Direction& v) {
    return 0.1F + std::exp(12 * (((l + v).normalized() ^ peak) - 1));
  };
  const auto btf = btf_of(directions, directions, lobe);
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  std::vector<float> abrdf(3 * samples.pairs);
  btf->abrdf(0, 0, abrdf);
  const std::vector<float> texel = channel_arrays(samples, abrdf, 1);
  const Modes modes = modes_named("optimal", 3, true);
  TexelFitter fitter(samples, modes, 6);
  fitter.set_texel(texel);
  for (const double lambda : {0.5, 3.0, 40.0, 1e4, 1e8}) {
    INFO("lambda " << lambda);
    Kernels kernels({6, 3});
    std::ranges::copy(modes.angles, kernels.angles().begin());
    for (std::size_t j = 0; j < 6; ++j) {
      for (std::size_t k = 0; k < 3; ++k) {
        for (int c = 0; c < 3; ++c)
          kernels.centre(j, k)[c] = lambda * (j % 2 == 0 ? -peak[c] : peak[c]);
      }
    }
    const TexelFit start = fitter.as_it_is(kernels);
    const TexelFit end = fitter.descend(start, {.iterations = 60});
    for (const double v : end.kernels.values()) REQUIRE(std::isfinite(v));
    CHECK(!end.fell_back);
    CHECK(end.value.total <= start.value.total);
    if (lambda < 10) CHECK(end.value.total < 0.5 * start.value.total);
  }
}

TEST_CASE("SRBF fits data where light and view cancel in a mode, a_k = -b_k, and a_k = b_k = 0") {
  // The second cannot be written down: a and b are a cosine and a sine of one angle. What it would
  // make, a psi of no length, comes of the first where light = view: lights and views are the same
  // directions here, so that it does at every eighteenth pair.
  const auto directions = named_directions("regular:3x6");
  const auto back = [](const Direction& l, const Direction& v) {
    return 0.1F + std::exp(6 * ((l ^ v) - 1));  // brightest there
  };
  const auto btf = btf_of(directions, directions, back);
  CHECK(error_of(btf, 1.1F, {"modes=half-difference"}) < 0.4);
  CHECK(error_of(btf, 1.1F, {"modes_a_kernel=4"}) < 0.08);
}

TEST_CASE("SRBF in halfs is finite up to 65504, and 1e8") {
  const auto directions = named_directions("regular:3x6");
  for (const float largest : {1.0F, 65504.0F, 1e8F, 1e30F}) {
    INFO("largest " << largest);
    const auto lobe = [&](const Direction& l, const Direction& v) {
      return largest * (0.001F + std::exp(40 * ((l + v).normalized().z - 1)));
    };
    const auto btf = btf_of(directions, directions, lobe);
    Progress silent;
    const auto fit = codec_named("srbf").fit(
        btf, Settings::from_text("", "test", {"kernels=6", "iterations=50"}), silent);
    CHECK(fitted_error(*btf, *fit, largest) < 0.02);
    const Model& model = dynamic_cast<const SrbfRepresentation&>(*fit).model();
    CHECK(model.storage == Storage::half);
    for (const float value : model.values) {
      REQUIRE(std::abs(value) <= 1);
      REQUIRE(value == static_cast<float>(half(value)));
    }
    for (const float scale : model.scale) REQUIRE(std::isfinite(scale));
  }
}

TEST_CASE("SRBF counts texels whose fit diverges in its report, and shows them black") {
  // Near the largest float the Lanczos filter overflows, so that the coarser level is infinite; the
  // data themselves are not.
  const auto directions = named_directions("regular:2x4");
  const float large = 3.3e38F;
  auto btf = std::make_shared<Btf>(2, 2, HemisphereSampling(directions),
                                   HemisphereSampling(directions), PixelType::float32);
  for (std::size_t i = 0; i < 4 * directions.size() * directions.size(); ++i)
    btf->set(i / 4 % directions.size(), i / 4 / directions.size(), i % 2, i / 2 % 2, Rgb(large));
  Progress silent;
  const auto fit = codec_named("srbf").fit(
      btf, Settings::from_text("", "test", {"kernels=3", "iterations=10", "modes=half-light-view"}),
      silent);
  const Model& model = dynamic_cast<const SrbfRepresentation&>(*fit).model();
  CHECK(model.report.find("\"fallbacks\":1") != std::string::npos);
  CHECK(model.report.find("\"fallbacks\":0") != std::string::npos);
  for (const float value : model.values) REQUIRE(std::isfinite(value));
  CHECK(fit->evaluate({0.5F, 0.5F}, directions[0], directions[0], 1).x == 0);
  CHECK(fit->evaluate({0.25F, 0.25F}, directions[0], directions[0], 0).x == Approx(large));
}

TEST_CASE("SRBF: halfs of traced data err within 2 percent of what the fit did in double") {
  AcquisitionSettings settings;
  settings.trace = {.width = 2, .height = 2, .spp = 16, .max_bounces = 4, .seed = 5};
  const auto btf = std::make_shared<Btf>(
      acquire(read_mesostructure(mesostructure_folder() / "tissue.toml"), settings));
  Progress silent;
  const auto fit = codec_named("srbf").fit(
      btf,
      Settings::from_text("", "test",
                          {"bits=float", "iterations=20", "starts=1", "modes=half-light-view"}),
      silent);
  Model halfs = dynamic_cast<const SrbfRepresentation&>(*fit).model();
  halfs.storage = Storage::half;
  bool changed = false;
  for (float& value : halfs.values) {
    changed = changed || value != stored_value(Storage::half, value);
    value = stored_value(Storage::half, value);
  }
  CHECK(changed);
  const double whole = sample_error(*btf, *fit).relative_rmse;
  CHECK(whole > 0.03);
  CHECK(sample_error(*btf, SrbfRepresentation(std::move(halfs))).relative_rmse ==
        Approx(whole).epsilon(0.02));
}
