// What free angles do for the error of single texels, everything else being the same.

#include <catch2/catch.hpp>
#include <cmath>

#include "codecs/srbf/texel_fit.h"
#include "tests/codecs/synthetic_btf.h"
#include "tests/codecs/synthetic_kernels.h"

using namespace weft;
using namespace weft::srbf;

TEST_CASE("SRBF: from one start, free angles end no worse than fixed ones, and lower in the mean") {
  const auto btf = realistic_btf(8, "regular:5x12");
  const Samples samples(btf->views(), btf->lights(), Quantity::radiance);
  const Modes fixed = modes_named("half-light-view", 3, true);
  const Modes free = modes_named("optimal", 3, true);
  // The start is where fixed angles end, so that nothing but the angles is left to differ: from
  // elsewhere each may end in another valley.
  const DescentLimits to_the_end{.iterations = 500, .decrease = 1e-5};
  double log_ratios = 0;
  int texels = 0;
  for (int t = 0; t < 64; t += 7) {
    const std::vector<float> texel = texel_of(*btf, samples, t % 8, t / 8);
    TexelFitter with_fixed(samples, fixed, 8);
    TexelFitter with_free(samples, free, 8);
    with_fixed.set_texel(texel);
    with_free.set_texel(texel);
    const TexelFit start = with_fixed.from_scratch(1, to_the_end);
    const double fixed_error = with_fixed.descend(start, to_the_end).value.data;
    const double free_error = with_free.descend(start, to_the_end).value.data;
    const double ratio = std::sqrt(free_error / fixed_error);
    INFO("texel " << t);
    CHECK(ratio < 1.001);
    log_ratios += std::log(ratio);
    ++texels;
  }
  const double mean = std::exp(log_ratios / texels);
  WARN("free angles end with " << mean << " of the error of fixed ones, in the geometric mean of "
                               << texels << " texels");
  CHECK(mean < 0.98);
}
