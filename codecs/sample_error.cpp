#include "codecs/sample_error.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>
#include <vector>

#include "codecs/luminance.h"

namespace weft {

namespace {

struct Sums {
  double error = 0;
  double data = 0;
  double count = 0;
  double luminance_error = 0;
  double luminance = 0;
};

std::vector<AppearanceQuery> texel_queries(const Btf& btf, int x, int y) {
  const Texcoord uv((static_cast<float>(x) + 0.5F) / static_cast<float>(btf.width()),
                    1 - (static_cast<float>(y) + 0.5F) / static_cast<float>(btf.height()));
  std::vector<AppearanceQuery> queries;
  queries.reserve(btf.views().size() * btf.lights().size());
  for (const Direction& view : btf.views().directions()) {
    for (const Direction& light : btf.lights().directions())
      queries.push_back({uv, light, view, 0});
  }
  return queries;
}

Sums texel_sums(const Btf& btf, const Representation& representation, int x, int y) {
  const std::vector<AppearanceQuery> queries = texel_queries(btf, x, y);
  std::vector<Rgb> answers(queries.size());
  std::vector<float> values(3 * queries.size());
  representation.evaluate(queries, answers);
  btf.abrdf(x, y, values);
  Sums sums;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (!(queries[i].light.z > 0) || !(queries[i].view.z > 0)) continue;
    double luminance_error = 0;
    for (int c = 0; c < 3; ++c) {
      const double wanted = values[3 * i + c];
      const double difference = answers[i][c] - wanted;
      sums.error += difference * difference;
      sums.data += wanted * wanted;
      ++sums.count;
      luminance_error += luminance_of_rgb[c] * difference;
      sums.luminance += luminance_of_rgb[c] * wanted;
    }
    sums.luminance_error += std::abs(luminance_error);
  }
  return sums;
}

}  // namespace

SampleError sample_error(const Btf& btf, const Representation& representation) {
  std::vector<Sums> texels(static_cast<std::size_t>(btf.width()) * btf.height());
  tbb::parallel_for(0, btf.width() * btf.height(), [&](int t) {
    texels[t] = texel_sums(btf, representation, t % btf.width(), t / btf.width());
  });
  Sums all;
  for (const Sums& texel : texels) {
    all.error += texel.error;
    all.data += texel.data;
    all.count += texel.count;
    all.luminance_error += texel.luminance_error;
    all.luminance += texel.luminance;
  }
  const auto relative = [](double error, double data) {
    if (data > 0) return error / data;
    return error > 0 ? std::numeric_limits<double>::infinity() : 0.0;
  };
  SampleError result;
  if (all.count > 0) result.rmse = std::sqrt(all.error / all.count);
  result.relative_rmse = std::sqrt(relative(all.error, all.data));
  result.luminance_difference = relative(all.luminance_error, all.luminance);
  return result;
}

}  // namespace weft
