// Fits all texels of one mip level, side by side: each from the best start among its parent's and
// its neighbours' kernels (paper 001, section 3.3.3), pulled towards them.
#pragma once

#include <vector>

#include "btf/progress.h"
#include "codecs/srbf/fit.h"
#include "codecs/srbf/mip_levels.h"
#include "codecs/srbf/texel_fit.h"

namespace weft::srbf {

struct LevelResult {
  std::vector<Kernels> kernels;  ///< of every texel
  double squared_error = 0;      ///< mean over texels, pairs and channels, in units of `scale`^2
  std::size_t fallbacks = 0;     ///< texels whose descent was thrown away
  std::size_t restarts = 0;      ///< texels that another start than their parent served better
};

/// @param parents  kernels of level + 1; empty at the top, which starts from scratch.
/// @param hints    another start for each texel; may be empty.
/// @param scale    what data are divided by.
LevelResult fit_level(const MipLevels& data, const Samples& samples, const FitOptions& options,
                      int level, const std::vector<Kernels>& parents,
                      const std::vector<Kernels>& hints, double scale, Progress& progress);

}  // namespace weft::srbf
