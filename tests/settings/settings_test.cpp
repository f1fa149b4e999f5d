// Settings: places in errors, unknown keys, types, ranges, overrides, canonical text.
#include "settings/settings.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <functional>

#include "btf/error.h"
#include "settings/nearest_name.h"
#include "tests/temporary_folder.h"

using namespace weft;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    CHECK(error.kind() == Error::Kind::bad_input);
    return error.what();
  }
  return "no error";
}

Settings toml(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return Settings::from_text(text, "brick.toml", overrides);
}

}  // namespace

TEST_CASE("values are answered, and fallbacks where they are absent") {
  const Settings s = toml(
      "n = 2\nx = 0.5\nf = true\nt = 'word'\nv = [1, 2.5, -3]\nc = 0.25\nuv = [0.5, 1]\n"
      "[sub]\nk = 7\n[[light]]\na = 1\n[[light]]\na = 2\n");
  CHECK(s.number("n") == 2);
  CHECK(s.number("x", 1, 0, 1) == 0.5);
  CHECK(s.number("absent", 4) == 4);
  CHECK(s.integer("n", 0, 0, 10) == 2);
  CHECK(s.integer("m", 5, 0, 10) == 5);
  CHECK(s.flag("f", false));
  CHECK(s.text("t") == "word");
  CHECK(s.choice("t", {"other", "word"}) == "word");
  CHECK(s.choice("u", {"other", "word"}) == "other");
  CHECK(s.vec3("v") == Vec3(1, 2.5, -3));
  CHECK(s.rgb("c", Rgb(0, 0, 0)) == Rgb(0.25, 0.25, 0.25));
  CHECK(s.vec2("uv", Vec2(0, 0)) == Vec2(0.5, 1));
  CHECK(s.table("sub").integer("k", 0, 0, 9) == 7);
  CHECK(s.table("none").number("k", 3) == 3);
  REQUIRE(s.tables("light").size() == 2);
  for (const Settings& light : s.tables("light")) light.number("a");
  CHECK(s.tables("light")[1].number("a") == 2);
  CHECK(s.tables("no_light").empty());
  CHECK(s.keys() == std::vector<std::string>{"c", "f", "light", "n", "sub", "t", "uv", "v", "x"});
  CHECK_NOTHROW(s.finish());
  CHECK_NOTHROW(Settings().finish());
}

TEST_CASE("an unknown key is refused with its line and the name that was meant") {
  const Settings s = toml("height = 1\n\n[yarn]\nradus = 2\n");
  s.number("height");
  s.table("yarn").number("radius", 1);
  const std::string text = message([&] { s.finish(); });
  CHECK_THAT(text,
             StartsWith("brick.toml:4:1: unknown key 'yarn.radus'; did you mean 'yarn.radius'"));
  CHECK_THAT(text, Contains("valid here: radius"));

  const Settings top = toml("height = 1\nheigth = 2\n");
  top.number("height");
  CHECK_THAT(message([&] { top.finish(); }), StartsWith("brick.toml:2:1: unknown key 'heigth'"));

  const Settings element = toml("light = [ { type = 'point', pos = 1 } ]");
  for (const Settings& light : element.tables("light")) light.text("type");
  CHECK_THAT(message([&] { element.finish(); }), Contains("unknown key 'light.0.pos'"));

  const Settings table = toml("[materials.red]\ntype = 'lambert'\n");
  CHECK_THAT(message([&] { table.finish(); }), Contains("unknown key 'materials'"));
}

TEST_CASE("half a file is a syntax error with line and column") {
  CHECK_THAT(message([] { toml("type = 'mesh'\nfile = \"bri"); }), StartsWith("brick.toml:2:"));
  CHECK_THAT(message([] { toml("a = 1\n[materials.rai"); }), StartsWith("brick.toml:2:"));
  CHECK_THAT(message([] { toml("a = 1\na = 2\n"); }), StartsWith("brick.toml:2:"));
  CHECK_THAT(message([] { Settings::from_file("/nowhere/at_all.toml"); }),
             Contains("/nowhere/at_all.toml") && Contains("No such file"));
  CHECK_THAT(message([] { Settings::from_file("/tmp"); }), Contains("not a file"));
}

TEST_CASE("wrong types and ranges are refused") {
  const Settings s = toml(
      "a = 'x'\nb = 1.5\nc = nan\nd = [1, 2]\ne = 3\ng = [0.1, inf, 1]\nh = -1\nk = [1e39, 0, "
      "0]\n");
  const auto says = [&](const std::function<void()>& action, const std::string& start,
                        const std::string& part) {
    CHECK_THAT(message(action), StartsWith(start) && Contains(part));
  };
  says([&] { s.number("a"); }, "brick.toml:1:1", "expected a number");
  says([&] { s.integer("b", 0, 0, 9); }, "brick.toml:2:1", "expected an integer");
  says([&] { s.number("c"); }, "brick.toml:3:1", "finite");
  says([&] { s.vec3("d"); }, "brick.toml:4:1", "three numbers");
  says([&] { s.number("e", 0, 0, 1); }, "brick.toml:5:1", "'e' is 3, expected 0 to 1");
  says([&] { s.integer("e", 0, 4, 9); }, "brick.toml:5:1", "expected 4 to 9");
  says([&] { s.numbers("g"); }, "brick.toml:6:1", "finite");
  says([&] { s.rgb("h", Rgb(0, 0, 0)); }, "brick.toml:7:1", "negative");
  says([&] { s.vec3("k"); }, "brick.toml:8:1", "too large");
  says([&] { s.flag("e", true); }, "brick.toml:5:1", "true or false");
  says([&] { s.text("e"); }, "brick.toml:5:1", "a string");
  says([&] { s.table("e"); }, "brick.toml:5:1", "a table");
  says([&] { s.tables("d"); }, "brick.toml:4:1", "an array of tables");
  says([&] { s.choice("a", {"xy", "z"}); }, "brick.toml:1:1", "one of xy, z");
  says([&] { s.number("absent"); }, "brick.toml", "'absent' is missing");
  says([&] { s.table("t").number("absent"); }, "brick.toml", "'t.absent' is missing");
}

TEST_CASE("overrides replace, add and are refused like any key") {
  const std::string text =
      "h = 1\nfile = 'a.obj'\n[m.red]\ntype = 'plastic'\nior = 1.5\n[[light]]\nx = 1\n";
  CHECK(toml(text, {"h=2"}).number("h") == 2);
  CHECK(toml(text, {"h=2", "h=3"}).number("h") == 3);
  CHECK(toml(text, {"new.deep.key=[1, 2]"}).table("new").table("deep").numbers("key").size() == 2);
  CHECK(toml(text, {"m.red.ior=1.3"}).table("m").table("red").number("ior") == 1.3);
  CHECK(toml(text, {"light.0.x=5"}).tables("light")[0].number("x") == 5);
  CHECK(toml(text, {"name=fibonacci:64"}).text("name") == "fibonacci:64");
  CHECK(toml(text, {"name='quoted'"}).text("name") == "quoted");
  CHECK(toml(text, {"file=../b.obj"}).path("file") == "../b.obj");

  const auto refused = [&](const std::string& pair, const std::string& part) {
    CHECK_THAT(message([&] { toml(text, {pair}); }), StartsWith("--set " + pair) && Contains(part));
  };
  refused("h", "'=' is missing");
  refused("h=", "empty");
  refused("h=[1, 2", "");
  refused("light.3.x=1", "no element of an array of 1");
  refused("h.x=1", "no table around");
  refused("a..b=1", "empty");

  const Settings unknown = toml(text, {"h=2", "yarn.radus=1"});
  for (const char* key : {"h", "file", "m", "light"}) unknown.has(key);
  unknown.table("yarn").number("radius", 1);
  CHECK_THAT(
      message([&] { unknown.finish(); }),
      StartsWith("--set yarn.radus=1: unknown key 'yarn.radus'; did you mean 'yarn.radius'"));
  CHECK_THAT(message([&] { toml(text, {"h=word"}).number("h"); }), StartsWith("--set h=word"));
  CHECK_THAT(message([&] { toml(text, {"h=nan"}).number("h"); }), Contains("finite"));
}

TEST_CASE("an overridden type leaves the keys of the type that the file had aside") {
  const std::string text = "[red]\ntype = 'plastic'\nior = 1.5\n";
  const Settings changed = toml(text, {"red.type=lambert", "red.albedo=1"});
  CHECK(changed.table("red").text("type") == "lambert");
  CHECK(changed.table("red").number("albedo") == 1);
  CHECK_NOTHROW(changed.finish());
  CHECK(changed.canonical_json() == R"({"red":{"albedo":1,"type":"lambert"}})");

  const Settings mistyped = toml(text, {"red.type=lambert", "red.albdo=1"});
  mistyped.table("red").text("type");
  CHECK_THAT(message([&] { mistyped.finish(); }), Contains("red.albdo"));
}

TEST_CASE("defaults fill in a table that does not name its type") {
  const std::string defaults = "type = 'plastic'\nior = 1.5\n";
  CHECK(toml("").table("m", defaults).number("ior") == 1.5);
  CHECK(toml("[m]\nior = 2\n").table("m", defaults).text("type") == "plastic");
  CHECK(toml("[m]\nior = 2\n").table("m", defaults).number("ior") == 2);
  const Settings none = toml("");
  CHECK(none.table("m").table("red", defaults).number("ior") == 1.5);
  CHECK(none.canonical_json() == R"({"m":{"red":{"ior":1.5,"type":"plastic"}}})");
  CHECK_FALSE(toml("[m]\ntype = 'lambert'\n").table("m", defaults).has("ior"));
}

TEST_CASE("canonical JSON has sorted keys, shortest numbers and no folders") {
  const Settings a =
      toml("z = 0.1\nb = 1.0\nfile = 'deep/down/x.obj'\n[m]\nq = [1, 2.50]\nl = 1e-7\n");
  a.path("file");
  CHECK(a.canonical_json() == R"({"b":1,"file":"x.obj","m":{"l":1e-07,"q":[1,2.5]},"z":0.1})");
  const Settings b =
      toml("b = 1\nfile = 'x.obj'\nz = 0.10\nm = { l = 0.0000001, q = [1.0, 2.5] }\n");
  b.path("file");
  CHECK(a.canonical_json() == b.canonical_json());
  CHECK(toml("x = 1\n", {"x=2"}).canonical_json() == R"({"x":2})");
}

TEST_CASE("paths are relative to the file they stand in") {
  const TemporaryFolder folder;
  std::ofstream(folder.path / "a.toml") << "file = 'b.obj'\nwhole = '/x/y'\n";
  const Settings s = Settings::from_file(folder.path / "a.toml");
  CHECK(s.path("file") == folder.path / "b.obj");
  CHECK(s.path("whole") == "/x/y");

  std::ofstream(folder.path / "b.obj") << "v 0 0 0\n";
  const std::string before = s.canonical_json();
  CHECK_THAT(before,
             Contains("\"file\":\"b.obj\",\"file.xxh3_128\":\"") && Contains("\"whole\":\"y\""));
  std::ofstream(folder.path / "b.obj") << "v 0 0 1\n";
  CHECK(s.canonical_json() != before);
}

TEST_CASE("the nearest name is found, and none where nothing is near") {
  CHECK(nearest_name("heigth", {"height", "weight"}) == "height");
  CHECK(nearest_name("chekcer", {"rings", "checker"}) == "checker");
  CHECK(nearest_name("xyz", {"checker", "rings"}).empty());
  CHECK_THAT(name_hint("ring", {"rings", "tissue"}), Contains("did you mean 'rings'"));
}
