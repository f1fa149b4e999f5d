// Arrays in memory and in scratch files, and a BTF that lies in one.

#include "btf/large_array.h"

#include <catch2/catch.hpp>
#include <cstdint>
#include <fstream>
#include <memory>

#include "btf/atomic_file.h"
#include "btf/btf.h"
#include "btf/btf_file.h"
#include "btf/error.h"
#include "tests/temporary_folder.h"

using namespace weft;
namespace fs = std::filesystem;

namespace {

bool all_zero(const LargeArray<float>& array) {
  return std::ranges::all_of(array.values(), [](float value) { return value == 0; });
}

bool is_aligned(const LargeArray<float>& array) {
  return reinterpret_cast<std::uintptr_t>(array.data()) % 64 == 0;
}

/// 7 views, 5 lights, 3 x 4 texels, every value another one.
Btf counted_btf(PixelType type) {
  Btf btf(3, 4, HemisphereSampling(named_directions("fibonacci:7")),
          HemisphereSampling(named_directions("fibonacci:5")), type);
  float value = 0;
  for (std::size_t view = 0; view < 7; ++view) {
    std::vector<float> values(5 * 4 * 3 * 3);
    for (float& v : values) v = ++value;
    btf.set_view(view, values);
  }
  return btf;
}

bool same_values(const Btf& a, const Btf& b) {
  return std::ranges::equal(a.halfs(), b.halfs()) && std::ranges::equal(a.floats(), b.floats());
}

}  // namespace

TEST_CASE("Arrays take of a budget while it lasts, and then lie in files without a name") {
  const TemporaryFolder folder;
  const auto budget = std::make_shared<MemoryBudget>(1000, folder.path);
  LargeArray<float> first(200, budget);
  CHECK(!first.mapped());
  CHECK(budget->left() == 200);
  {
    const LargeArray<float> second(100, budget);
    CHECK(second.mapped());
    CHECK(budget->left() == 200);
    CHECK(all_zero(second));
    CHECK(is_aligned(second));
    CHECK(fs::is_empty(folder.path));
    first = LargeArray<float>();
    CHECK(budget->left() == 1000);
    LargeArray<float> copy = second;
    CHECK(!copy.mapped());
    copy[99] = 3;
    CHECK(second[99] == 0);
  }
  CHECK(budget->left() == 1000);
  const LargeArray<float> unlimited(200);
  CHECK(!unlimited.mapped());
  CHECK(all_zero(unlimited));
  CHECK(is_aligned(unlimited));
  CHECK(LargeArray<float>(0, budget).size() == 0);
}

TEST_CASE("A scratch folder that is not there or not a folder is named") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "file") << "text";
  for (const char* name : {"nowhere", "file"}) {
    const auto budget = std::make_shared<MemoryBudget>(0, folder.path / name);
    CHECK_THROWS_WITH(LargeArray<float>(10, budget),
                      Catch::Contains(name) && Catch::Contains("TMPDIR"));
  }
  // More than any disk has.
  const auto budget = std::make_shared<MemoryBudget>(0, folder.path);
  CHECK_THROWS_WITH(LargeArray<char>(std::size_t{1} << 60, budget),
                    Catch::Contains("has no room") && Catch::Contains("TMPDIR"));
  CHECK(std::distance(fs::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("A dataset read into a scratch file has the values and bytes of one in memory") {
  for (const PixelType type : {PixelType::half, PixelType::float32}) {
    const TemporaryFolder folder;
    const Btf btf = counted_btf(type);
    write_btf(folder.path / "a.btf", btf);
    const std::size_t view = btf.bytes() / 7;
    // One view at a time, itself in a file; two at a time; all but one.
    for (const std::size_t memory : {std::size_t{0}, 4 * view, 7 * view - 1}) {
      INFO(memory);
      const Btf mapped =
          read_btf(folder.path / "a.btf", std::make_shared<MemoryBudget>(memory, folder.path));
      CHECK(mapped.mapped());
      CHECK(same_values(mapped, btf));
      fs::remove_all(folder.path / "b.btf");
      write_btf(folder.path / "b.btf", mapped);
      CHECK(read_text(folder.path / "b.btf" / "btf.json") ==
            read_text(folder.path / "a.btf" / "btf.json"));
    }
    const auto ample = std::make_shared<MemoryBudget>(8 * view, folder.path);
    const Btf in_memory = read_btf(folder.path / "a.btf", ample);
    CHECK(!in_memory.mapped());
    CHECK(ample->left() == view);
    CHECK(same_values(in_memory, btf));
  }
}

TEST_CASE("Views are taken out and set as they lie, as many at a time as memory allows") {
  const TemporaryFolder folder;
  const Btf btf = counted_btf(PixelType::half);
  const Btf part = btf.some_views(2, 3);
  REQUIRE(part.views().size() == 3);
  for (std::size_t v = 0; v < 3; ++v) CHECK(part.view_values(v) == btf.view_values(v + 2));
  Btf copy = btf.blank_views(0, 7);
  copy.set_views(4, btf.some_views(4, 3));
  copy.set_views(0, btf.some_views(0, 4));
  CHECK(same_values(copy, btf));

  Btf mapped(3, 4, btf.views(), btf.lights(), btf.pixel_type(),
             std::make_shared<MemoryBudget>(btf.bytes() / 7 * 4, folder.path));
  CHECK(mapped.views_at_once() == 2);
  mapped.set_views(0, btf);
  std::vector<std::size_t> firsts;
  for_some_views(mapped, [&](std::size_t first, const Btf& some) {
    firsts.push_back(first);
    CHECK(!some.mapped());
    for (std::size_t v = 0; v < some.views().size(); ++v)
      CHECK(some.view_values(v) == btf.view_values(first + v));
  });
  CHECK(firsts == std::vector<std::size_t>{0, 2, 4, 6});
  for_some_views(btf, [&](std::size_t, const Btf& some) { CHECK(&some == &btf); });
}
