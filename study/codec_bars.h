// What codecs are held to, and the fits that it takes to tell: CMF and HF against their paper
// (Suykens et al. 2003, section 4.4, table 2 and figure 3), the rest against limits of our own.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

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

/// One number and what it is held to.
struct Bar {
  std::string what;
  std::string unit;  ///< may be empty
  double value = 0;
  double limit = 0;
  bool at_least = false;  ///< else the value is to lie below the limit
  bool met() const { return at_least ? value >= limit : value < limit; }
};

using CodecBenches = std::map<std::string, CodecBench>;

/// The bars that these benches tell, others left out.
/// @param codecs    defaults, by the codec's name.
/// @param variants  of `factor_variants`, by their names.
std::vector<Bar> codec_bars(const CodecBenches& codecs, const CodecBenches& variants);

}  // namespace weft
