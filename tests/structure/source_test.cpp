// Rules that hold for every source file of the repository.

#include <catch2/catch.hpp>
#include <filesystem>

TEST_CASE("The repository's folders are where this test looks") {
  REQUIRE(std::filesystem::exists(std::filesystem::path(WEFT_SOURCE_DIR) / "btf" / "btf.h"));
}
