// What codecs are held to, and the fits that it takes to tell: CMF and HF against their paper
// (Suykens et al. 2003, section 4.4, table 2 and figure 3), lobes against the models that theirs
// compares them with (Filip and Haindl 2004, table 1), SRBF against other variables of its kernels
// (Tsai et al. 2011, figures 4.1 and 4.3), the rest against limits of our own.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "study/bar.h"
#include "study/codec_bench.h"

namespace weft {

/// A codec with parameters other than its own defaults, or on another dataset.
struct CodecVariant {
  std::string name;
  std::string codec;
  std::vector<std::string> parameters;  ///< "KEY=VALUE"
};

/// The fits of the paper's own case, tissue with `regular:16x8` lights and views: in 8 bits and
/// floats, with and without codebooks, and HF by its smoothing.
std::span<const CodecVariant> factor_variants();

/// Fits that are held against each other on one structure: lobes, PTM and Lafortune models.
std::span<const CodecVariant> compared_models();

/// The same of SRBF by its variables, fitted nearly to the end (minutes for a small tile), and with
/// defaults in halfs and floats.
std::span<const CodecVariant> compared_kernels();

using CodecBenches = std::map<std::string, CodecBench>;

/// The bars that these benches tell, others left out.
/// @param codecs    defaults, by the codec's name.
/// @param variants  of `factor_variants`, by their names.
std::vector<Bar> codec_bars(const CodecBenches& codecs, const CodecBenches& variants);

/// @param structure  what the bars begin with; lobes are held to half of PTM's difference on
///                   "checker" and "rings", to less than it on others.
/// @param fits       of `compared_models` or `compared_kernels` on it, by their names; some may be
/// missing.
std::vector<Bar> comparison_bars(const std::string& structure, const CodecBenches& fits);

}  // namespace weft
