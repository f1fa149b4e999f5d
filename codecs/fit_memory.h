// How `--memory` is shared between what a fit works with and the arrays that grow with the data.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "btf/btf_file.h"
#include "btf/large_array.h"
#include "codecs/representation.h"

namespace weft {

/// What a fit with the codec's default parameters, from reading the data to writing the result,
/// takes at most beside the arrays of a `MemoryBudget`: it grows with the texels (of some
/// codecs: times views) and with the pairs, never with their product
/// (tests/cli/compress_memory_test.cpp).
std::size_t fit_working_bytes(const BtfHeader& data, const Codec& codec, std::size_t threads);

/// What is left for those arrays of `memory` bytes for the whole process.
/// @throws Error  bad_input, saying the least, where there is not enough to work.
std::shared_ptr<MemoryBudget> fit_budget(std::size_t memory, const BtfHeader& data,
                                         const Codec& codec, std::filesystem::path scratch_folder);

}  // namespace weft
