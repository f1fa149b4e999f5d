// No half of a fitted codec is infinite, whatever the data's range: in the textures, in the files
// and in the middle of a decoder that computes in halfs.
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "btf/error.h"
#include "btf/random.h"
#include "btf/vector.h"
#include "codecs/lafortune/lafortune_representation.h"
#include "codecs/reflectance_fields/representation.h"
#include "codecs/representation.h"
#include "codecs/sample_error.h"
#include "images/image_file.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

constexpr float largest_half = 65504;

/// Values up to `largest`: a sharp highlight in blue alone at one texel, at the other a floor that
/// is 1e-6 times as bright.
std::shared_ptr<const Btf> bright_btf(float largest) {
  Btf btf(2, 1, HemisphereSampling(named_directions("regular:2x3")),
          HemisphereSampling(named_directions("regular:5x12")), PixelType::float32);
  for (std::size_t v = 0; v < btf.views().size(); ++v) {
    for (std::size_t l = 0; l < btf.lights().size(); ++l) {
      const Direction& light = btf.lights()[l];
      const float sharp = std::pow(std::max((light ^ Direction(0.6F, 0, 0.8F)), 0.F), 60.F);
      btf.set(l, v, 0, 0, Rgb(0, 0, largest * sharp));
      btf.set(l, v, 1, 0, Rgb(largest * 1e-6F * light.z));
    }
  }
  return std::make_shared<const Btf>(std::move(btf));
}

struct Way {
  std::string codec;
  std::vector<std::string> parameters;
};

const std::vector<Way>& ways() {
  static const std::vector<Way> ways{
      {"lobes", {"lobes=4"}},     {"ptm", {}},
      {"ptm", {"cosine=inside"}}, {"ptm", {"colour=channels"}},
      {"lafortune", {"lobes=3"}}, {"srbf", {"kernels=3", "iterations=10", "starts=1"}}};
  return ways;
}

std::unique_ptr<Representation> fitted(const std::shared_ptr<const Btf>& btf, const Way& way) {
  Progress silent;
  return codec_named(way.codec).fit(btf, Settings::from_text("", "test", way.parameters), silent);
}

/// What a decoder in halfs meets at most: each of the terms that it sums up, times the colour.
float largest_sum(const std::vector<float>& numbers, std::size_t stride, bool is_lobes,
                  bool has_diffuse) {
  float largest = 0;
  for (std::size_t at = 0; at < numbers.size(); at += stride) {
    const float* last = &numbers[at + stride - 4];
    float sum = has_diffuse ? last[3] : 0;
    for (std::size_t i = 0; i + 4 < stride; i += is_lobes ? 4 : 1) {
      const float* w = &numbers[at + i];
      sum += is_lobes ? std::hypot(w[0], w[1], w[2]) : std::abs(w[0]);
    }
    for (int c = 0; c < 3; ++c) largest = std::max(largest, sum * last[c]);
  }
  return largest;
}

float largest_sum(const Representation& representation) {
  using lafortune::LafortuneRepresentation;
  using reflectance_fields::FieldRepresentation;
  if (const auto* one = dynamic_cast<const LafortuneRepresentation*>(&representation))
    return largest_sum(one->model().texels, 4 * one->model().quads(), true, true);
  const auto* fields = dynamic_cast<const FieldRepresentation*>(&representation);
  if (fields == nullptr) return 0;
  const auto& model = fields->model();
  if (!is_rgb(model.kind)) {
    return largest_sum(model.fields, model.floats_a_field(),
                       model.kind == reflectance_fields::Kind::lobes, false);
  }
  float largest = 0;
  for (std::size_t at = 0; at < model.fields.size(); at += model.floats_a_field()) {
    for (std::size_t c = 0; c < 3; ++c) {
      float sum = 0;
      for (std::size_t k = 0; k < 6; ++k) sum += std::abs(model.fields[at + 4 * k + c]);
      largest = std::max(largest, sum);
    }
  }
  return largest;
}

void expect_finite_files(const Representation& representation) {
  const TemporaryFolder folder;
  representation.save(folder.path / "a");
  int images = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "a")) {
    if (entry.path().extension() != ".exr") continue;
    ++images;
    for (const float value : read_image(entry.path(), Encoding::linear).values) {
      REQUIRE(std::isfinite(value));
      REQUIRE(std::abs(value) <= largest_half);
    }
  }
  CHECK(images > 0);
  CHECK_NOTHROW(open_representation(folder.path / "a"));
}

}  // namespace

TEST_CASE("Halfs never overflow: fitted codecs are as near to bright data as to dim ones") {
  for (const Way& way : ways()) {
    const auto error = [&](float largest) {
      const auto btf = bright_btf(largest);
      const auto representation = fitted(btf, way);
      expect_finite_files(*representation);
      CHECK(largest_sum(*representation) < largest_half);
      for (int i = 0; i < 200; ++i) {
        const auto unit = [&](int what) { return unit_float(hash_coordinates(3, i, what)); };
        const Rgb value = representation->evaluate(
            {unit(0), 0.5F}, from_spherical(radians(90 * unit(1)), radians(360 * unit(2))),
            from_spherical(radians(89 * unit(3)), radians(360 * unit(4))), 0);
        for (int c = 0; c < 3; ++c) {
          CHECK(value[c] >= 0);
          CHECK(value[c] <= 6 * largest);
        }
      }
      return sample_error(*btf, *representation).relative_rmse;
    };
    const double usual = error(1);
    // L-BFGS stops elsewhere after a few steps where the last bits differ.
    const double tolerance = way.codec == "srbf" ? 1 : 0.02;
    for (const float largest : {1e-9F, 65504.F, 1.3e8F, 1e18F}) {
      INFO(way.codec << " " << largest);
      CHECK(error(largest) == Approx(usual).epsilon(tolerance).margin(tolerance * 1e-3));
    }
  }
}

TEST_CASE("Halfs never overflow: at the ends of a float's range data are scaled or refused") {
  for (const Way& way : ways()) {
    for (const float largest : {std::numeric_limits<float>::denorm_min(), 1e-40F, 1e-35F, 1e30F,
                                std::numeric_limits<float>::max()}) {
      INFO(way.codec << " " << largest);
      try {
        const auto representation = fitted(bright_btf(largest), way);
        expect_finite_files(*representation);
        CHECK(largest_sum(*representation) < largest_half);
      } catch (const Error& error) {
        CHECK(largest > 1e36F);
        CHECK_THAT(error.what(), Catch::Contains("BTF"));
      }
    }
  }
}
