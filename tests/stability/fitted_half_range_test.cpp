// No half of a fitted codec is infinite, whatever the data's range: in the textures, in the files
// and in the middle of a decoder that computes in halfs, which lobes are decoded by here.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <numbers>
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

half sum(half a, half b) {
  return half(static_cast<float>(a) + static_cast<float>(b));
}
half product(half a, half b) {
  return half(static_cast<float>(a) * static_cast<float>(b));
}
half quotient(half a, half b) {
  return half(static_cast<float>(a) / static_cast<float>(b));
}
using Half3 = std::array<half, 3>;
half dot(const Half3& a, const Half3& b) {
  return sum(sum(product(a[0], b[0]), product(a[1], b[1])), product(a[2], b[2]));
}

void require_finite(std::initializer_list<half> values) {
  REQUIRE(std::ranges::all_of(values, [](half value) { return value.isFinite(); }));
}

/// |w| max(<w, l> / |w|, 0)^n, rounded to a half after each operation. In place of w its ratio to
/// its largest component is squared: squares of what is below 2e-4 are no halfs. A cosine that is
/// rounded to above one is held, else its power may be several times too large.
half lobe_in_halfs(const float* quad, const Half3& light) {
  const half largest(std::max({std::abs(quad[0]), std::abs(quad[1]), std::abs(quad[2])}));
  if (largest == half(0.F)) return largest;
  Half3 ratio;
  for (std::size_t c = 0; c < 3; ++c) ratio[c] = quotient(half(quad[c]), largest);
  const half length(std::sqrt(static_cast<float>(dot(ratio, ratio))));
  const half along = dot(ratio, light);
  require_finite({length, along});
  if (!(along > half(0.F))) return half(0.F);
  const half cosine(std::min(static_cast<float>(quotient(along, length)), 1.F));
  const half power(std::pow(static_cast<float>(cosine), quad[3]));
  const half peak = product(largest, length);
  const half value = product(peak, power);
  require_finite({cosine, power, peak, value});
  return value;
}

/// A field over `scale`, which is a float: the picture's exposure.
Half3 field_in_halfs(const float* field, std::size_t lobes, const Half3& light) {
  half value(0.F);
  for (std::size_t k = 0; k < lobes; ++k) value = sum(value, lobe_in_halfs(field + 4 * k, light));
  Half3 rgb;
  for (std::size_t c = 0; c < 3; ++c) rgb[c] = product(half(field[4 * lobes + c]), value);
  require_finite({value, rgb[0], rgb[1], rgb[2]});
  return rgb;
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
    const double factor = way.codec == "srbf" ? 4 : 1.02;
    for (const float largest : {1e-9F, 65504.F, 1.3e8F, 1e18F}) {
      INFO(way.codec << " " << largest);
      const double found = error(largest);
      CHECK(found < factor * usual + (factor - 1) * 1e-3);
      CHECK(usual < factor * found + (factor - 1) * 1e-3);
    }
  }
}

TEST_CASE("Halfs never overflow: lobes decoded in halfs are finite after each operation") {
  const Direction bright(0.6F, 0, 0.8F);
  for (const float largest : {1e-9F, 1.F, 65504.F, 1e18F}) {
    for (const char* count : {"lobes=1", "lobes=4"}) {
      const auto representation = fitted(bright_btf(largest), {"lobes", {count}});
      const auto& model =
          dynamic_cast<const reflectance_fields::FieldRepresentation&>(*representation).model();
      const std::size_t stride = model.floats_a_field();
      float brightest = 0;
      for (int i = 0; i < 300; ++i) {
        const auto unit = [&](int what) { return unit_float(hash_coordinates(5, i, what)); };
        const Direction at = i % 10 == 0 ? bright
                                         : from_spherical(std::acos(double{1 - unit(0)}),
                                                          2 * std::numbers::pi * unit(1));
        const Half3 light{half(at.x), half(at.y), half(at.z)};
        const half right(unit(2));
        const half left(1 - unit(2));
        for (std::size_t view = 0; view < model.head.views.size(); ++view) {
          const float* fields = &model.fields[2 * view * stride];  // of two texels
          const Half3 a = field_in_halfs(fields, model.lobes, light);
          const Half3 b = field_in_halfs(fields + stride, model.lobes, light);
          for (std::size_t c = 0; c < 3; ++c) {
            const half blend = sum(product(a[c], left), product(b[c], right));
            require_finite({blend});
            brightest = std::max(brightest, static_cast<float>(blend));
          }
        }
      }
      INFO(count << " " << largest);
      CHECK(brightest > 1000);  // of 8,192 and a peak of about one
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
