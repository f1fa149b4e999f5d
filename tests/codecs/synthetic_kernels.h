// Kernels, and BTFs that are made of them, for the tests of the codec `srbf`.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "btf/btf.h"
#include "codecs/srbf/kernels.h"
#include "codecs/srbf/samples.h"

namespace weft::srbf {

/// Kernels as a fit might end with: lambda up to `widest`, positive colours.
Kernels some_kernels(Shape shape, double widest, std::uint64_t seed = 0);

/// A BTF whose texels are such kernels' sums.
std::shared_ptr<const Btf> btf_of(const std::vector<Kernels>& texels, int width,
                                  const std::string& directions);

/// A texel's B, as fits see it.
std::vector<float> texel_of(const Btf& btf, const Samples& samples, int x = 0, int y = 0);

}  // namespace weft::srbf
