#include "study/codec_bench.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "btf/direction.h"
#include "btf/random.h"
#include "codecs/sample_error.h"
#include "study/peak_memory.h"

namespace weft {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// What is computed must be used, or a compiler that sees through `evaluate` leaves it out.
void use(const Rgb& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

std::vector<Rgb> answers_of(const Appearance& appearance,
                            std::span<const AppearanceQuery> queries) {
  std::vector<Rgb> answers(queries.size());
  appearance.evaluate(queries, answers);
  return answers;
}

double relative_difference(std::span<const Rgb> wanted, std::span<const Rgb> found) {
  double error = 0;
  double square = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double difference = static_cast<double>(found[i][c]) - wanted[i][c];
      error += difference * difference;
      square += static_cast<double>(wanted[i][c]) * wanted[i][c];
    }
  }
  return square > 0 ? std::sqrt(error / square) : std::sqrt(error);
}

std::vector<float> lods_of(const Appearance& appearance) {
  std::vector<float> lods{0};
  if (!appearance.has_lod()) return lods;
  const int side = std::max(appearance.texels().x, appearance.texels().y);
  if (side > 1) lods.push_back(0.5F);
  for (float lod = 1; std::exp2(lod) <= static_cast<float>(side); ++lod) lods.push_back(lod);
  return lods;
}

std::vector<LevelBench> bench_levels(const Appearance& fitted, const Appearance& raw) {
  constexpr std::size_t compared = 16384;
  std::vector<LevelBench> levels;
  for (const float lod : lods_of(fitted)) {
    const std::vector<AppearanceQuery> queries = decode_queries(compared, lod);
    levels.push_back({.lod = lod,
                      .decode = decode_times(fitted, decode_queries(1024, lod)),
                      .relative_rmse = relative_difference(answers_of(raw, queries),
                                                           answers_of(fitted, queries))});
  }
  return levels;
}

}  // namespace

std::vector<AppearanceQuery> decode_queries(std::size_t count, float lod) {
  std::vector<AppearanceQuery> queries;
  for (std::uint64_t i = 0; i < count; ++i) {
    const auto number = [i](int dimension) { return unit_float(hash_coordinates(i, dimension)); };
    const auto direction = [&](int dimension) {
      const double z = 1 - number(dimension);  // in (0, 1]
      return from_spherical(std::acos(z), 2 * std::numbers::pi * number(dimension + 1));
    };
    queries.push_back({Texcoord(number(0), number(1)), direction(2), direction(4), lod});
  }
  return queries;
}

DecodeTimes decode_times(const Appearance& appearance, std::span<const AppearanceQuery> queries) {
  constexpr int passes = 301;
  const auto count = static_cast<double>(queries.size());
  std::vector<Rgb> answers(queries.size());
  std::array<std::vector<double>, 2> seconds;
  for (int pass = 0; pass <= passes; ++pass) {
    const auto begin = Clock::now();
    for (const AppearanceQuery& q : queries) use(appearance.evaluate(q.uv, q.light, q.view, q.lod));
    const double single = seconds_since(begin);
    const auto batch_begin = Clock::now();
    appearance.evaluate(queries, answers);
    use(answers.front());
    const double batched = seconds_since(batch_begin);
    if (pass == 0) continue;
    seconds[0].push_back(single);
    seconds[1].push_back(batched);
  }
  constexpr double nanoseconds = 1e9;
  return {.single = nanoseconds * median(seconds[0]) / count,
          .batched = nanoseconds * median(seconds[1]) / count};
}

CodecBench bench_codec(const Codec& codec, const std::vector<std::string>& parameters,
                       const std::shared_ptr<const Btf>& btf, Progress& progress) {
  const Settings settings = Settings::from_text("", "--set", parameters);
  CodecBench bench;
  const PeakMemory memory;
  const auto begin = Clock::now();
  const std::unique_ptr<Representation> fitted = codec.fit(btf, settings, progress);
  bench.fit_seconds = seconds_since(begin);
  if (const auto growth = memory.growth())
    bench.fit_memory = 1 + static_cast<double>(*growth) / static_cast<double>(btf->bytes());
  progress.finish();
  bench.levels = bench_levels(*fitted, *codec_named("raw").fit(btf, Settings(), progress));
  bench.decode = bench.levels.front().decode;
  const SampleError error = sample_error(*btf, *fitted);
  bench.rmse = error.rmse;
  bench.relative_rmse = error.relative_rmse;
  bench.luminance_difference = error.luminance_difference;
  bench.texels = static_cast<std::size_t>(btf->width()) * static_cast<std::size_t>(btf->height());
  bench.bytes = fitted->bytes();
  bench.constant_bytes = fitted->constant_bytes();
  bench.ratio = compression_ratio(*fitted);
  return bench;
}

}  // namespace weft
