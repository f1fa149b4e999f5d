#include "codecs/fit_memory.h"

#include <fmt/core.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "btf/error.h"
#include "btf/process_memory.h"

namespace weft {

namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20;

// Half as much again as the codec that takes most: 56 MiB at 64 x 64 texels and 81 x 81 directions.
constexpr std::size_t bytes_always = 32 * mebibyte;
constexpr std::size_t bytes_a_thread_and_pair = 2048;  // a block of 16 ABRDFs, a few times
constexpr std::size_t bytes_a_pair = 1024;             // components of a matrix's other side

}  // namespace

std::size_t fit_working_bytes(const BtfHeader& data, const Codec& codec, std::size_t threads) {
  const std::size_t texels = static_cast<std::size_t>(data.width) * data.height;
  const std::size_t pairs = data.views.size() * data.lights.size();
  const std::size_t fit =
      threads * pairs * bytes_a_thread_and_pair + texels * codec.fit_bytes_a_texel +
      texels * data.views.size() * codec.fit_bytes_a_texel_and_view + 3 * pairs * bytes_a_pair;
  const std::size_t one_view = 3 * texels * data.lights.size() * 2 * sizeof(float);
  return bytes_always + std::max(fit, one_view);
}

std::shared_ptr<MemoryBudget> fit_budget(std::size_t memory, const BtfHeader& data,
                                         const Codec& codec, std::filesystem::path scratch_folder) {
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  const std::size_t working = anonymous_bytes() + fit_working_bytes(data, codec, threads);
  if (memory < working) {
    throw bad_input("--memory",
                    fmt::format("is {:.0f} MiB; expected at least {:.0f} MiB: what a fit of these "
                                "data works with, beside the data",
                                static_cast<double>(memory) / mebibyte,
                                std::ceil(static_cast<double>(working) / mebibyte)));
  }
  return std::make_shared<MemoryBudget>(memory - working, std::move(scratch_folder));
}

}  // namespace weft
