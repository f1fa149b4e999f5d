// What is special about the DFMF: what it is exact for, and that errors are relative ones.

#include <catch2/catch.hpp>
#include <cmath>

#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

std::unique_ptr<Representation> fit(const std::string& codec, const std::shared_ptr<const Btf>& btf,
                                    const std::vector<std::string>& parameters) {
  Progress progress;
  return codec_named(codec).fit(btf, Settings::from_text("", "test", parameters), progress);
}

// Root mean square of the relative error of each sample's green.
double relative_error(const Btf& btf, const Representation& representation) {
  double sum = 0;
  double count = 0;
  for (int t = 0; t < btf.width() * btf.height(); ++t) {
    const int x = t % btf.width();
    const int y = t / btf.width();
    const Texcoord uv((static_cast<float>(x) + 0.5F) / static_cast<float>(btf.width()),
                      1 - (static_cast<float>(y) + 0.5F) / static_cast<float>(btf.height()));
    for (std::size_t v = 0; v < btf.views().size(); ++v) {
      for (std::size_t l = 0; l < btf.lights().size(); ++l) {
        const double wanted = btf.at(l, v, x, y).y;
        const double found = representation.evaluate(uv, btf.lights()[l], btf.views()[v], 0).y;
        sum += std::pow((found - wanted) / wanted, 2);
        ++count;
      }
    }
  }
  return std::sqrt(sum / count);
}

}  // namespace

TEST_CASE("DFMF: two components of the logarithm are exact for powers, which a PCA is not for") {
  const auto btf =
      synthetic_btf(3, 2, "regular:3x6", "regular:3x6",
                    [](int x, int y, const Direction& light, const Direction& view) {
                      const float exponent = 1 + static_cast<float>(x + 3 * y) / 1.5F;
                      return Rgb(0.8F, 0.5F, 0.2F) * std::pow(2 + light.x + view.y, exponent);
                    });
  const auto fitted =
      fit("dfmf", btf,
          {"components_y=1", "components_u=1", "components_v=1", "bits=float", "epsilon=1e-6"});
  CHECK(sample_error(*btf, *fitted).relative_rmse > 1e-3);
  const auto two =
      fit("dfmf", btf,
          {"components_y=2", "components_u=1", "components_v=1", "bits=float", "epsilon=1e-6"});
  const double error = sample_error(*btf, *two).relative_rmse;
  CHECK(error < 3e-4);
  const auto pca = fit("pca", btf, {"components=2", "bits=float"});
  CHECK(sample_error(*btf, *pca).relative_rmse > 5 * error);
}

TEST_CASE("DFMF tells dark samples apart that a PCA of as many bytes does not") {
  const auto btf = synthetic_btf(8, 8, "regular:3x6", "regular:3x6",
                                 [](int x, int y, const Direction& light, const Direction& view) {
                                   const float dark = x < 4 ? 1.0F : 1e-3F;
                                   return Rgb(dark, dark, dark) *
                                          (half_pattern(x, y, (light + view).normalized()).y);
                                 });
  const auto dfmf =
      fit("dfmf", btf, {"components_y=8", "components_u=1", "components_v=1", "epsilon=1e-5"});
  const auto pca = fit("pca", btf, {"components=8"});
  CHECK(dfmf->bytes() < pca->bytes());
  CHECK(relative_error(*btf, *dfmf) < 0.2 * relative_error(*btf, *pca));
}

TEST_CASE("DFMF errs less with more components") {
  const auto btf = realistic_btf(8, "regular:3x6");
  double before = 1;
  for (const std::string n : {"2", "6", "18"}) {
    const double error =
        sample_error(*btf, *fit("dfmf", btf,
                                {"components_y=" + n, "components_u=" + n, "components_v=" + n}))
            .relative_rmse;
    INFO(n << " components: " << error);
    CHECK(error < 0.8 * before);
    before = error;
  }
}
