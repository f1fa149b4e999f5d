// What a piece of work held at its largest is told, whatever ran before.
#include "study/peak_memory.h"

#include <sys/mman.h>

#include <catch2/catch.hpp>

namespace {

constexpr std::size_t mebibyte = 1 << 20;

/// Takes memory, all of it present, and gives it back: to and from the system itself, since an
/// allocator may keep books beside it (address sanitizer's has a byte for eight), and without
/// writing, of which thread sanitizer keeps four bytes for each.
void hold(std::size_t bytes) {
  void* const mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_POPULATE, -1, 0);
  REQUIRE(mapped != MAP_FAILED);
  REQUIRE(munmap(mapped, bytes) == 0);
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
