// What a texel of extreme values does to a fit: it never ends the others', it is counted where
// nothing fits it, and named where no float holds what does.

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "btf/error.h"
#include "btf/random.h"
#include "codecs/reflectance_fields/model.h"
#include "codecs/sample_error.h"
#include "codecs/srbf/level_fit.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

constexpr int bad_x = 2;
constexpr int bad_y = 1;

/// Of 4 x 4 texels, one alternates between `dark` and `bright` without any order.
std::shared_ptr<const Btf> with_a_bad_texel(float dark, float bright) {
  Btf btf = *realistic_btf(4, "regular:3x6");
  for (std::size_t v = 0; v < btf.views().size(); ++v) {
    for (std::size_t l = 0; l < btf.lights().size(); ++l) {
      const bool is_bright = unit_float(hash_coordinates(41, v, static_cast<int>(l))) < 0.5F;
      btf.set(l, v, bad_x, bad_y, Rgb(1, 1, 1) * (is_bright ? bright : dark));
    }
  }
  return std::make_shared<const Btf>(std::move(btf));
}

std::unique_ptr<Representation> fitted(const std::string& codec,
                                       const std::shared_ptr<const Btf>& btf,
                                       const std::vector<std::string>& parameters,
                                       Progress& progress) {
  return codec_named(codec).fit(btf, Settings::from_text("", "test", parameters), progress);
}

}  // namespace

TEST_CASE("A fit of a BTF with one bad texel ends, and errs nowhere beyond what the data are") {
  const auto btf = with_a_bad_texel(1e-7F, 65504.F);
  for (const std::string codec : {"srbf", "lobes", "lafortune", "ptm"}) {
    INFO(codec);
    Progress progress;
    const std::vector<std::string> parameters =
        codec == "srbf" ? std::vector<std::string>{"kernels=6", "iterations=30"}
                        : std::vector<std::string>{};
    const auto found = fitted(codec, btf, parameters, progress);
    CHECK(sample_error(*btf, *found).relative_rmse < 1);
    for (const auto& [name, value] : progress.reported()) {
      INFO(name);
      CHECK(std::isfinite(value));
      if (name == "texels_that_fell_back") CHECK(value <= 21);  // 4 x 4 and their mip levels
    }
  }
}

TEST_CASE("A fit that no float holds names the texel, and what to do") {
  constexpr float largest = std::numeric_limits<float>::max();
  Progress progress;
  const auto expect_named = [](const std::string& place, const std::function<void()>& fit) {
    using Catch::Contains;
    CHECK_THROWS_WITH(fit(), Contains(place) && Contains("float's range") &&
                                 Contains("weft extract") && Contains("power of ten"));
  };
  const auto btf = with_a_bad_texel(largest / 2, largest);
  expect_named("BTF: texel (2, 1)", [&] { fitted("lafortune", btf, {}, progress); });
  expect_named("view 0, texel (2, 1)", [&] { fitted("ptm", btf, {"colour=channels"}, progress); });

  reflectance_fields::Model fields = reflectance_fields::empty_model(
      *btf, "lobes", reflectance_fields::Kind::lobes, 2, Storage::half, "{}");
  const std::size_t field = 5 * 16 + 4 * bad_y + bad_x;
  fields.fields[field * fields.floats_a_field() + 9] = std::numeric_limits<float>::infinity();
  expect_named("view 5, texel (2, 1)", [&] { reflectance_fields::store_fields(fields); });

  srbf::Model model{.head = fitted_head(*btf, "{}")};
  model.shape = {3, 2};
  for (const auto& [texel, place] : {std::pair(4 * bad_y + bad_x, "mip level 0, texel (2, 1)"),
                                     std::pair(16 + 3, "mip level 1, texel (1, 1)"),
                                     std::pair(20, "mip level 2, texel (0, 0)")}) {
    std::vector<srbf::Kernels> kernels(21, srbf::Kernels(model.shape));
    kernels[texel].colours()[4] = 1e20;
    CHECK_NOTHROW(model.set_kernels(kernels, 1e10));
    expect_named(place, [&] { model.set_kernels(kernels, 1e20); });
  }
}

TEST_CASE("SRBF: a parent whose error is no number gives way to any that is one") {
  using namespace weft::srbf;
  const auto btf = realistic_btf(4, "regular:3x6");
  const MipLevels data(*btf);
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  FitOptions options;
  options.kernels = 4;
  options.modes = modes_named("half-light-view", 3, true);
  options.iterations = 20;
  options.sweeps = 0;
  Progress silent;
  const LevelResult top = fit_level(data, samples, options, 2, {}, {}, 1, silent);
  std::vector<Kernels> parents =
      fit_level(data, samples, options, 1, top.kernels, {}, 1, silent).kernels;
  const auto squared_error = [&] {
    return fit_level(data, samples, options, 0, parents, {}, 1, silent).squared_error;
  };
  const double usual = squared_error();
  parents[3].centre(1, 0)[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(squared_error() < 2 * usual);
}
