// The GPU's own filter in place of the SRBF codec's: nearly the same, for it knows only a few
// blends between two texels.

#include <cmath>

#include "codecs/representation.h"
#include "gl_preview/gpu_decode.h"
#include "tests/gl_preview/gl_or_skip.h"
#include "tests/gl_preview/procedural_btf.h"
#include "tests/gl_preview/random_queries.h"

using namespace weft;

TEST_CASE("SRBF numbers that the GPU filters decode nearly as those that the program blends") {
  const auto context = gl_or_skip();
  if (!context) return;
  for (const auto& [width, height] : {std::pair(8, 8), std::pair(5, 3)}) {
    const auto btf = procedural_btf(width, height, "regular:3x8", PixelType::half);
    for (const std::string bits : {"half", "8"}) {
      INFO(width << " x " << height << ", " << bits);
      Progress silent;
      // Decoders must agree on any numbers, so that none are drawn together here.
      const auto fitted = codec_named("srbf").fit(
          btf,
          Settings::from_text("", "test",
                              {"filtering=numbers", "smooth_weight=0", "mip_weight=0", "sweeps=1",
                               "kernels=5", "iterations=20", "bits=" + bits}),
          silent);
      std::vector<AppearanceQuery> queries;
      for (std::uint64_t i = 0; i < 4000; ++i)
        queries.push_back(random_query(i, static_cast<float>(i % 16) * 0.25F));
      std::vector<Rgb> wanted(queries.size());
      fitted->evaluate(queries, wanted);
      const auto found = decode_on_gpu(fitted->gl_program(), queries);
      double errors = 0;
      double squares = 0;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
          errors += std::pow(found[i][c] - wanted[i][c], 2);
          squares += std::pow(wanted[i][c], 2);
        }
      }
      CHECK(std::sqrt(errors / squares) < (bits == "8" ? 0.06 : 0.01));  // blends have 8 bits, too
    }
  }
}
