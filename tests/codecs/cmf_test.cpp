// CMF against data whose factors are known, and what 8 bits and clustering cost.

#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "tests/codecs/synthetic_btf.h"

using namespace weft;

namespace {

double cmf_error(const std::shared_ptr<const Btf>& btf,
                 const std::vector<std::string>& parameters) {
  Progress progress;
  const auto fitted =
      codec_named("cmf").fit(btf, Settings::from_text("", "test", parameters), progress);
  return sample_error(*btf, *fitted).relative_rmse;
}

}  // namespace

TEST_CASE("Data that is P(light) R(view) comes back without Q") {
  const auto btf = synthetic_btf(5, 4, "ubo81", "ubo81",
                                 [](int x, int y, const Direction& l, const Direction& v) {
                                   return light_pattern(x, y, l) * view_pattern(x, y, v);
                                 });
  CHECK(cmf_error(btf, {"factors=light,view", "bits=float", "clustered=false"}) < 1e-4);
  CHECK(cmf_error(btf, {"factors=light,view", "bits=float"}) < 1e-4);  // 20 texels, 256 clusters
}

TEST_CASE(
    "Data that is Q(half) comes back to the error of resampling, which falls with resolution") {
  const auto btf = synthetic_btf(1, 1, "fibonacci:500", "fibonacci:500",
                                 [](int x, int y, const Direction& l, const Direction& v) {
                                   return half_pattern(x, y, (l + v).normalized());
                                 });
  double previous = 0.3;
  for (const std::string resolution : {"16", "32", "64"}) {
    const double error =
        cmf_error(btf, {"bits=float", "clustered=false", "resolution=" + resolution});
    INFO("resolution " << resolution << ": " << error << ", before " << previous);
    CHECK(error < previous);
    previous = error;
  }
  CHECK(previous < 0.02);
}

TEST_CASE("Refining reaches what the chain leaves of P Q R") {
  const auto btf = synthetic_btf(
      2, 2, "ubo81", "ubo81", [](int x, int y, const Direction& l, const Direction& v) {
        return light_pattern(x, y, l) * half_pattern(x, y, (l + v).normalized()) *
               view_pattern(x, y, v);
      });
  const double chain = cmf_error(btf, {"bits=float", "clustered=false"});
  const double refined = cmf_error(btf, {"bits=float", "clustered=false", "refine=50"});
  INFO("P Q R: chain " << chain << ", refined " << refined);
  CHECK(refined < 0.01);
  CHECK(refined < chain);
}

TEST_CASE("8 bits add less than 5 % to the error") {
  const auto btf = realistic_btf(16, "ubo81");
  for (const std::string clustered : {"false", "true"}) {
    const double in_floats =
        cmf_error(btf, {"clustered=" + clustered, "clusters=64", "bits=float"});
    const double in_bytes = cmf_error(btf, {"clustered=" + clustered, "clusters=64", "bits=8"});
    INFO("clustered=" << clustered << ": float " << in_floats << ", 8-bit " << in_bytes);
    CHECK(in_bytes < 1.05 * in_floats);
    CHECK(in_floats < 0.35);
  }
}
