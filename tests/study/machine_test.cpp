// A measurement can say what it was taken on.
#include "study/machine.h"

#include <catch2/catch.hpp>

TEST_CASE("This machine has a name, cores and a system") {
  const weft::Machine machine = weft::this_machine();
  CHECK(machine.cores >= 1);
  for (const std::string& text : {machine.processor, machine.system}) {
    CHECK_FALSE(text.empty());
    CHECK(text.find('"') == std::string::npos);
    CHECK(text.front() != ' ');
  }
}
