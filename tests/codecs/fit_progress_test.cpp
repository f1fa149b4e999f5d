// While they run, fits show the error so far.

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "codecs/sample_error.h"
#include "codecs/srbf/srbf_representation.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

/// The number after `words` in what was noted last.
double number_after(const std::string& words, const Progress& progress) {
  INFO("noted: " << progress.noted());
  const std::size_t at = progress.noted().find(words);
  REQUIRE(at != std::string::npos);
  return std::stod(progress.noted().substr(at + words.size()));
}

}  // namespace

TEST_CASE("SRBF fits show the RMSE of the texels so far, in the data's units") {
  const auto btf = realistic_btf(8, "regular:3x6");
  Progress progress;
  const auto found = codec_named("srbf").fit(
      btf, Settings::from_text("", "test", {"kernels=6", "iterations=20", "bits=float"}), progress);
  CHECK_THAT(progress.noted(), Catch::EndsWith("1/sr"));
  // Texels that end at the same time may be one apart in what they tell.
  CHECK(number_after("RMSE ", progress) == Approx(sample_error(*btf, *found).rmse).epsilon(0.1));
}

TEST_CASE("Fits of lobes, of Lafortune's model and of polynomials show the error so far") {
  const auto btf = realistic_btf(4, "regular:3x6");
  for (const std::string codec : {"lobes", "lafortune", "ptm"}) {
    INFO(codec);
    Progress progress;
    codec_named(codec).fit(btf, Settings(), progress);
    const double percent = number_after("luminance error ", progress);
    CHECK(percent > 0.1);
    CHECK(percent < 100);
  }
}
