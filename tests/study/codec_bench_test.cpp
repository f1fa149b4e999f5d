// What the bench of codecs tells, on data whose numbers are known.
#include "study/codec_bench.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>
#include <thread>

#include "btf/direction.h"
#include "codecs/sample_error.h"
#include "codecs/srbf/fit.h"
#include "study/codec_bars.h"

namespace {

using weft::CodecBench;

// Answers after a while, at once where many are asked.
class Slow : public weft::Appearance {
 public:
  weft::Rgb evaluate(weft::Texcoord, weft::Direction, weft::Direction, float) const override {
    wait();
    return {1, 1, 1};
  }
  void evaluate(std::span<const weft::AppearanceQuery>, std::span<weft::Rgb>) const override {
    wait();
  }
  bool has_lod() const override { return false; }
  Imath::V2i texels() const override { return {1, 1}; }

 private:
  static void wait() { std::this_thread::sleep_for(std::chrono::microseconds(100)); }
};

std::shared_ptr<const weft::Btf> grey_btf() {
  const weft::HemisphereSampling sampling(
      {{0, 0, 1}, weft::from_spherical(0.7, 0), weft::from_spherical(0.7, 2)});
  auto btf = std::make_shared<weft::Btf>(8, 4, sampling, sampling, weft::PixelType::half);
  for (std::size_t v = 0; v < 3; ++v) {
    for (std::size_t l = 0; l < 3; ++l) {
      for (int t = 0; t < 32; ++t) btf->set(l, v, t % 8, t / 8, weft::Rgb(1, 1, 1) * sampling[l].z);
    }
  }
  return btf;
}

CodecBench with_rmse(double rmse) {
  CodecBench bench;
  bench.rmse = rmse;
  return bench;
}

CodecBench with_difference(double difference) {
  CodecBench bench = with_rmse(1);
  bench.luminance_difference = difference;
  return bench;
}

const weft::Bar* bar_named(const std::vector<weft::Bar>& bars, const std::string& part) {
  for (const weft::Bar& bar : bars) {
    if (bar.what.find(part) != std::string::npos) return &bar;
  }
  return nullptr;
}

}  // namespace

TEST_CASE(
    "Queries of the bench are of level 0, above the horizon, and spread over tile and sphere") {
  const auto queries = weft::decode_queries();
  REQUIRE(queries.size() == 1024);
  double light_z = 0;
  double u = 0;
  weft::Vec3 sum(0, 0, 0);
  for (const auto& q : queries) {
    CHECK((q.uv.x >= 0 && q.uv.x < 1 && q.uv.y >= 0 && q.uv.y < 1));
    CHECK((q.light.z > 0 && q.view.z > 0 && q.lod == 0));
    CHECK(q.light.length() == Approx(1));
    light_z += q.light.z;
    u += q.uv.x;
    sum += q.view;
  }
  // Even over the solid angle: the mean z is 1/2; five standard errors of 1,024.
  CHECK(light_z / 1024 == Approx(0.5).margin(0.045));
  CHECK(u / 1024 == Approx(0.5).margin(0.045));
  CHECK(sum.x / 1024 == Approx(0).margin(0.09));
}

TEST_CASE("Decoding is timed a query, one by one and batched") {
  const auto queries = weft::decode_queries();
  const auto times = weft::decode_times(Slow(), std::span(queries).first(4));
  CHECK(times.single >= 100e3);
  CHECK(times.batched >= 25e3);  // one wait for all four
  CHECK(times.batched < times.single / 2);
}

TEST_CASE("The bench tells of every codec what its representation tells") {
  const auto btf = grey_btf();
  for (const weft::Codec& codec : weft::codecs()) {
    INFO(codec.name);
    weft::Progress silent;
    const CodecBench bench = weft::bench_codec(codec, {}, btf, silent);
    const auto fitted = codec.fit(btf, weft::Settings(), silent);
    CHECK(bench.bytes == fitted->bytes());
    CHECK(bench.constant_bytes == fitted->constant_bytes());
    CHECK(bench.ratio == Approx(3.0 * 32 * 9 / static_cast<double>(fitted->bytes())));
    CHECK(bench.texels == 32);
    CHECK(bench.luminance_difference == weft::sample_error(*btf, *fitted).luminance_difference);
    CHECK(bench.fit_seconds > 0);
    CHECK(bench.decode.single > 0);
    CHECK(bench.decode.batched > 0);
    CHECK(bench.relative_rmse < 0.1);
    if (bench.fit_memory) CHECK(*bench.fit_memory >= 1);
    REQUIRE(bench.levels.size() == (fitted->has_lod() ? 5 : 1));  // 0, 0.5, 1, 2, 3 of 8 x 4 texels
    CHECK(bench.levels.back().lod == (fitted->has_lod() ? 3 : 0));
    for (const weft::LevelBench& level : bench.levels) {
      INFO("lod " << level.lod << ": " << level.relative_rmse);
      CHECK(level.decode.batched > 0);
      if (codec.name == "raw") CHECK(level.relative_rmse == 0);
    }
  }
}

TEST_CASE("A level of detail's error is against the data at that level") {
  // Two columns of texels, one twice as bright: what has no level but the finest errs at the other.
  const weft::HemisphereSampling sampling(weft::named_directions("fibonacci:12"));
  auto btf = std::make_shared<weft::Btf>(2, 2, sampling, sampling, weft::PixelType::float32);
  for (std::size_t v = 0; v < 12; ++v) {
    for (std::size_t l = 0; l < 12; ++l) {
      for (int t = 0; t < 4; ++t)
        btf->set(l, v, t % 2, t / 2, weft::Rgb(1, 1, 1) * sampling[l].z * (1.0F + t % 2));
    }
  }
  weft::Progress silent;
  const CodecBench bench =
      weft::bench_codec(weft::codec_named("laplacian"), {"levels=1"}, btf, silent);
  REQUIRE(bench.levels.size() == 3);
  INFO("level 0: " << bench.levels[0].relative_rmse << ", 1: " << bench.levels[2].relative_rmse);
  CHECK(bench.levels[2].relative_rmse > 2 * bench.levels[0].relative_rmse);
}

TEST_CASE("Parameters of a bench reach the codec") {
  weft::Progress silent;
  const weft::Codec& cmf = weft::codec_named("cmf");
  const auto btf = grey_btf();
  const std::size_t bytes = weft::bench_codec(cmf, {"resolution=16"}, btf, silent).bytes;
  CHECK(bytes < weft::bench_codec(cmf, {}, btf, silent).bytes);
  CHECK_THROWS(weft::bench_codec(cmf, {"no=1"}, btf, silent));
}

TEST_CASE("Bars are told of what was measured, and met below or from their limit on") {
  CHECK(weft::codec_bars({}, {}).empty());
  CodecBench quick;
  quick.fit_seconds = 29;
  quick.decode = {.single = 100, .batched = 50};
  quick.fit_memory = 3.5;
  const auto bars = weft::codec_bars({{"laplacian", quick}}, {});
  REQUIRE(bars.size() == 4);
  CHECK(bar_named(bars, "laplacian: fit")->met());
  CHECK(bar_named(bars, "laplacian: decode")->value == 100);
  CHECK(bar_named(bars, "batched")->value == 2);
  CHECK(bar_named(bars, "batched")->met());
  CHECK_FALSE(bar_named(bars, "memory")->met());

  const auto growths = weft::codec_bars({}, {{"cmf", with_rmse(0.115)},
                                             {"cmf unclustered", with_rmse(0.1)},
                                             {"cmf unclustered float", with_rmse(0.08)},
                                             {"cmf float", with_rmse(0)}});
  CHECK(bar_named(growths, "256 clusters")->value == Approx(15));
  CHECK_FALSE(bar_named(growths, "256 clusters")->met());
  CHECK(bar_named(growths, "floats, unclustered")->value == Approx(25));
  CHECK(bar_named(growths, "floats, clustered") == nullptr);  // nothing to divide by
}

TEST_CASE("SRBF's fit may take an hour where the tile is larger than 64 x 64 texels") {
  CodecBench slow;
  slow.fit_seconds = 1000;
  slow.texels = 64 * 64;
  CHECK_FALSE(bar_named(weft::codec_bars({{"srbf", slow}}, {}), "srbf: fit")->met());
  slow.texels = 128 * 128;
  CHECK(bar_named(weft::codec_bars({{"srbf", slow}}, {}), "srbf: fit")->met());
}

TEST_CASE("Codecs are held against each other where both were fitted to the structure") {
  CHECK(weft::comparison_bars("checker", {}).empty());
  const weft::CodecBenches fields{{"lobes", with_difference(0.6)},
                                  {"ptm", with_difference(1)},
                                  {"lafortune", with_difference(0.8)}};
  for (const std::string structure : {"checker", "rings", "tissue"}) {
    const auto bars = weft::comparison_bars(structure, fields);
    REQUIRE(bars.size() == 2);
    const weft::Bar& lobes = *bar_named(bars, structure + ", lobes");
    CHECK(lobes.value == Approx(0.6));
    CHECK(lobes.met() == (structure == "tissue"));  // the others are held to half
    CHECK(bar_named(bars, "Lafortune")->value == Approx(1.25));
    CHECK_FALSE(bar_named(bars, "Lafortune")->met());
  }
  const auto with = [](double rmse) {
    CodecBench bench = with_difference(1);
    bench.rmse = rmse;
    return bench;
  };
  const auto bars = weft::comparison_bars("rings", {{"srbf optimal", with(0.9)},
                                                    {"srbf default", with(0.9)},
                                                    {"srbf default float", with(0.89)},
                                                    {"srbf half-light-view", with(1)},
                                                    {"srbf half-half-half", with(1.2)},
                                                    {"srbf half-difference", with(0)},
                                                    {"srbf univariate", with(1.8)}});
  REQUIRE(bars.size() == 4);  // nothing is told of a fit without error
  CHECK(bar_named(bars, "(half, light, view)")->value == Approx(10));
  CHECK(bar_named(bars, "(half, light, view)")->met());
  CHECK(bar_named(bars, "(half, half, half)")->value == Approx(25));
  CHECK_FALSE(bar_named(bars, "(half, half, half)")->met());
  CHECK(bar_named(bars, "univariate")->met());
  CHECK(bar_named(bars, "floats")->value == Approx(100 * (0.9 / 0.89 - 1)));
  CHECK(bar_named(bars, "floats")->met());
}

TEST_CASE("Every variant is of a codec that there is, and has its own name") {
  for (const auto& variants :
       {weft::factor_variants(), weft::compared_models(), weft::compared_kernels()}) {
    for (const weft::CodecVariant& variant : variants) {
      CHECK_NOTHROW(weft::codec_named(variant.codec));
      CHECK(std::ranges::count(variants, variant.name, &weft::CodecVariant::name) == 1);
      if (variant.codec == "srbf") {
        INFO(variant.name);
        CHECK_NOTHROW(
            weft::srbf::fit_options(weft::Settings::from_text("", "test", variant.parameters)));
      }
    }
  }
}
