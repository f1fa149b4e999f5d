// What a piece of work held at its largest is told, whatever ran before.
#include "study/peak_memory.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <memory>

namespace {

constexpr std::size_t mebibyte = 1 << 20;

/// Takes memory, writes to all of it and gives it back.
void hold(std::size_t bytes) {
  const auto memory = std::make_unique_for_overwrite<unsigned char[]>(bytes);
  std::fill_n(memory.get(), bytes, static_cast<unsigned char>(7));
  CHECK(memory[bytes / 2] == 7);
}

double growth_of_holding(std::size_t bytes) {
  const weft::PeakMemory memory;
  if (!memory.growth()) return -1;
  hold(bytes);
  return static_cast<double>(*memory.growth()) / static_cast<double>(mebibyte);
}

}  // namespace

TEST_CASE("The largest resident set of a piece of work is its own") {
  const double large = growth_of_holding(200 * mebibyte);
  if (large < 0) {
    WARN("skipped: this system does not let the largest resident set be forgotten");
    return;
  }
  CHECK(large == Approx(200).margin(10));
  // The larger one before it hides nothing, and adds nothing.
  CHECK(growth_of_holding(50 * mebibyte) == Approx(50).margin(10));
}
