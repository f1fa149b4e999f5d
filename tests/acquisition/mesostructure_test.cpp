// Reading mesostructures: files, overrides, materials, placing into the tile, and what is refused.
#include "acquisition/mesostructure.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "btf/error.h"
#include "images/image_file.h"
#include "tests/acquisition/mesostructure_files.h"

using namespace weft;
using Catch::Matchers::Contains;

namespace {

const std::string square_obj =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.25\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n";
const std::string red_and_blue = "[materials.red]\nalbedo = 0.5\n[materials.blue]\nalbedo = 0.25\n";

std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    CHECK(error.kind() == Error::Kind::bad_input);
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("every mesostructure of the project reads, finite and with sound indices") {
  std::set<std::string> types;
  for (const std::string& name : mesostructure_names()) {
    INFO(name);
    const Mesostructure m = read_mesostructure(mesostructure_folder() / (name + ".toml"));
    types.insert(m.type);
    CHECK(m.mesh.triangles.size() < 320'000);
    CHECK(m.materials.size() == m.mesh.material_names.size());
    CHECK(m.mesh.materials.size() == m.mesh.triangles.size());
    CHECK((m.mesh.normals.empty() || m.mesh.normals.size() == m.mesh.positions.size()));
    CHECK(m.tile_size == 1);
    CHECK(m.settings.find("\"type\":\"" + m.type + "\"") != std::string::npos);
    float top = -1;
    for (const Vec3& p : m.mesh.positions) top = std::max(top, p.z);
    if (!m.curves.segments.empty()) top = std::max(top, bounds_of(m.curves).high.z);
    CHECK(m.reference_height == Approx(top));
    bool sound = true;
    for (const auto& t : m.mesh.triangles) {
      for (const std::uint32_t vertex : t) sound &= vertex < m.mesh.positions.size();
    }
    for (const Vec3& p : m.mesh.positions) sound &= std::isfinite(p.x + p.y + p.z);
    for (const std::uint16_t material : m.mesh.materials) sound &= material < m.materials.size();
    CHECK(m.curves.materials.size() == m.curves.segments.size());
    for (const std::uint32_t first : m.curves.segments)
      sound &= first + 3 < m.curves.controls.size();
    for (const std::uint16_t material : m.curves.materials) sound &= material < m.materials.size();
    CHECK(sound);
  }
  for (const MesostructureType& type : mesostructure_types()) {
    // A height field is of an image that the user brings.
    if (type.name == "heightfield") continue;
    INFO("an example of " << type.name);
    CHECK(types.contains(type.name));
  }
}

TEST_CASE("the registry's names are distinct, and its default materials are readable") {
  std::vector<std::string> names;
  for (const MesostructureType& type : mesostructure_types()) {
    CHECK_FALSE(type.summary.empty());
    CHECK_FALSE(type.parameters.empty());
    CHECK(std::find(names.begin(), names.end(), type.name) == names.end());
    names.push_back(type.name);
    for (const auto& [name, text] : type.default_materials) {
      const Settings settings = Settings::from_text(text, type.name + "." + name);
      CHECK_NOTHROW(read_bsdf(settings));
      CHECK_NOTHROW(settings.finish());
    }
  }
}

TEST_CASE("a mesh keeps its names, its units and its place") {
  const TemporaryFolder folder;
  write_file(folder, "a.obj", square_obj);
  const auto file = write_file(folder, "a.toml", "type = 'mesh'\nfile = 'a.obj'\n" + red_and_blue);
  const Mesostructure m = read_mesostructure(file, {"tile_size=2.5"});
  CHECK(m.mesh.material_names == std::vector<std::string>{"red", "blue"});
  CHECK(m.mesh.normals.empty());
  CHECK(m.tile_size == 2.5F);
  CHECK(m.reference_height == 0.25F);
  CHECK(read_mesostructure(file, {"reference_height=0.5"}).reference_height == 0.5F);

  const auto positions = [&](const std::vector<std::string>& overrides) {
    return read_mesostructure(file, overrides).mesh.positions;
  };
  CHECK(positions({"scale=0.5", "translate=[0.25, 0, 1]"})[2] == Vec3(0.75, 0.5, 1));
  CHECK(positions({"up=y"})[3] == Vec3(0, 0.75, 1));
  CHECK(positions({"up=y"})[2] == Vec3(1, 1, 1));
  CHECK(positions({"scale=3", "fit=true"})[2] == Vec3(3, 3, 0));
  CHECK_THAT(refusal([&] { positions({"scale=100"}); }), Contains("100 x 100 tiles wide"));
}

TEST_CASE("an offset shifts the content, and whole tiles of it change nothing") {
  const auto file = mesostructure_folder() / "checker.toml";
  const auto at = [&](const std::string& offset) {
    return read_mesostructure(file, {"resolution=16", "offset=" + offset}).mesh.positions;
  };
  const std::vector<Vec3> home = at("[0, 0]");
  const std::vector<Vec3> moved = at("[0.375, 0.25]");
  for (std::size_t i = 0; i < home.size(); ++i) CHECK(moved[i] == home[i] + Vec3(0.375, 0.25, 0));
  CHECK(at("[1, -2]") == home);
  CHECK(at("[-0.625, 3.25]") == moved);
}

TEST_CASE("a floor is added with its material") {
  const TemporaryFolder folder;
  write_file(folder, "a.obj", square_obj);
  const auto file = write_file(folder, "a.toml",
                               "type = 'mesh'\nfile = 'a.obj'\nfloor = { height = -0.5, material "
                               "= 'ground' }\noffset = [0.5, 0]\n" +
                                   red_and_blue + "[materials.ground]\nalbedo = 0.1\n");
  for (const bool smooth : {false, true}) {
    const Mesostructure m = read_mesostructure(file, {smooth ? "smooth=true" : "smooth=false"});
    CHECK(m.mesh.material_names.back() == "ground");
    CHECK(m.mesh.materials.back() == 2);
    CHECK(m.mesh.positions.back() == Vec3(0, 1, -0.5));
    CHECK(m.mesh.normals.size() == (smooth ? m.mesh.positions.size() : 0));
  }
}

TEST_CASE("materials fall to `default`, and those that are missing or unused are named") {
  const TemporaryFolder folder;
  write_file(folder, "a.obj", square_obj);
  const std::string head = "type = 'mesh'\nfile = 'a.obj'\n";
  const auto read = [&](const std::string& materials) {
    return read_mesostructure(write_file(folder, "a.toml", head + materials));
  };
  CHECK(read("[materials.default]\nalbedo = 0.5\n").materials.size() == 2);
  const std::string missing = refusal([&] { read("[materials.red]\nalbedo = 0.5\n"); });
  CHECK_THAT(missing, Contains("no material is given for blue"));
  const std::string unused =
      refusal([&] { read(red_and_blue + "[materials.bleu]\nalbedo = 1\n"); });
  CHECK_THAT(unused, Contains("a.toml:7") && Contains("'bleu'") && Contains("did you mean 'blue'"));
  CHECK_THAT(refusal([&] { read("[materials.default]\nalbdeo = 0.5\n"); }),
             Contains("a.toml:4:1") && Contains("did you mean 'materials.default.albedo'"));
}

TEST_CASE("a furnace is a few overrides away") {
  for (const auto& [name, materials] : {std::pair{"checker", std::vector{"raised", "low"}},
                                        {"tissue", {"weft", "warp", "floor"}}}) {
    std::vector<std::string> overrides;
    for (const std::string material : materials) {
      overrides.push_back("materials." + material + ".type=lambert");
      overrides.push_back("materials." + material + ".albedo=1");
    }
    const auto file = mesostructure_folder() / (std::string(name) + ".toml");
    const Mesostructure m = read_mesostructure(file, overrides);
    for (const Bsdf& material : m.materials) CHECK(material.kind() == Bsdf::Kind::lambert);
    CHECK(m.settings.find("ior") == std::string::npos);
  }
}

TEST_CASE("mistakes in a file are named with their line") {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text, const std::vector<std::string>& overrides = {}) {
    return refusal([&] { read_mesostructure(write_file(folder, "a.toml", text), overrides); });
  };
  CHECK_THAT(read("type = 'ring'\n"), Contains("a.toml:1:1") && Contains("did you mean 'rings'"));
  CHECK_THAT(read("type = 'checker'\nresolution = 16\nheigth = 1\n"),
             Contains("a.toml:3:1: unknown key 'heigth'; did you mean 'height'"));
  CHECK_THAT(read("type = 'checker'\n", {"smothing=0.1"}), Contains("--set smothing=0.1"));
  CHECK_THAT(read("height = 1\n"), Contains("'type' is missing"));
  CHECK_THAT(read("type = 'mesh'\n"), Contains("'file' is missing"));
  CHECK_THAT(read("type = 'mesh'\nfile = 'gone.obj'\n"),
             Contains("a.toml:2:1") && Contains("gone.obj") && Contains("no such file"));
  CHECK_THAT(read("type = 'heightfield'\nfile = 'gone.png'\n"),
             Contains("a.toml:2:1") && Contains("gone.png"));
  CHECK_THAT(read("type = 'rings'\nreference_height = -0.01\n"),
             Contains("a.toml:2:1") && Contains("lowest point is at 0,"));
  CHECK_THAT(read("type = 'rings'\n[materials.rings]\neta = 1.5\n"),
             Contains("a.toml:3:1") && Contains("either f0 or eta and k"));
  CHECK_THAT(read("type = 'tissue'\nwarp = 3\n"), Contains("a.toml:2:1") && Contains("even"));
  write_file(folder, "points.obj", "v 0 0 0\n");
  CHECK_THAT(read("type = 'mesh'\nfile = 'points.obj'\n"), Contains("mesh has no faces"));
}

TEST_CASE("a height field has the image's first row near v = 1, and wraps") {
  const TemporaryFolder folder;
  Image image(4, 2, 3);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) image.set_rgb(x, y, Rgb(static_cast<float>(x + 4 * y) / 8));
  }
  write_image(folder.path / "h.exr", image, Encoding::linear);
  const auto file =
      write_file(folder, "h.toml", "type = 'heightfield'\nfile = 'h.exr'\nheight = 0.5\n");
  const Mesostructure m = read_mesostructure(file);
  CHECK(m.mesh.triangles.size() == 16);
  const auto height_at = [&](float x, float y) {
    for (const Vec3& p : m.mesh.positions) {
      if (std::abs(p.x - x) < 1e-6F && std::abs(p.y - y) < 1e-6F) return p.z;
    }
    return std::numeric_limits<float>::quiet_NaN();
  };
  CHECK(height_at(0.125F, 0.75F) == 0.0F);
  CHECK(height_at(0.375F, 0.75F) == Approx(0.5 / 8));
  CHECK(height_at(0.125F, 0.25F) == Approx(0.5 * 4 / 8));
  CHECK(height_at(1.125F, 1.25F) == Approx(0.5 * 4 / 8));
  for (std::size_t t = 0; t < m.mesh.triangles.size(); t += 2) {
    const Vec3& first = m.mesh.positions[m.mesh.triangles[t][0]];
    const Vec3& last = m.mesh.positions[m.mesh.triangles[t][2]];
    CHECK((last.x > first.x && last.y > first.y));
  }

  image.set_rgb(2, 1, Rgb(std::numeric_limits<float>::quiet_NaN()));
  write_image(folder.path / "h.exr", image, Encoding::linear);
  CHECK_THAT(refusal([&] { read_mesostructure(file); }),
             Contains("h.exr") && Contains("pixel (2, 1)"));
}

TEST_CASE("bytes of a height field's image are heights as they stand, not colours") {
  const TemporaryFolder folder;
  Image image(2, 2, 3);
  for (int i = 0; i < 4; ++i) image.set_rgb(i % 2, i / 2, Rgb(128.0F / 255));
  write_image(folder.path / "h.png", image, Encoding::linear);
  const auto file =
      write_file(folder, "h.toml", "type = 'heightfield'\nfile = 'h.png'\nheight = 0.5\n");
  for (const Vec3& p : read_mesostructure(file).mesh.positions)
    CHECK(p.z == Approx(0.5 * 128 / 255).epsilon(1e-6));
}

TEST_CASE("a height field and the same field as an OBJ are the same mesh") {
  const TemporaryFolder folder;
  const int width = 8;
  const int height = 4;
  Image image(width, height, 3);
  const auto value = [](int x, int y) { return static_cast<float>((x * 5 + y * 3) % 7) / 8; };
  std::string obj;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) image.set_rgb(x, y, Rgb(value(x, y)));
  }
  for (int j = 0; j <= height; ++j) {
    for (int i = 0; i <= width; ++i) {
      obj += "v " + std::to_string((i + 0.5) / width) + " " + std::to_string((j + 0.5) / height) +
             " " + std::to_string(value(i % width, height - 1 - j % height)) + "\n";
    }
  }
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const int a = j * (width + 1) + i + 1;
      const int b = a + width + 1;
      obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) +
             " " + std::to_string(b) + "\n";
    }
  }
  write_file(folder, "h.obj", obj);
  write_image(folder.path / "h.exr", image, Encoding::linear);
  const auto image_file = write_file(
      folder, "i.toml", "type = 'heightfield'\nfile = 'h.exr'\nheight = 1\nsmooth = true\n");
  const auto obj_file = write_file(
      folder, "o.toml",
      "type = 'mesh'\nfile = 'h.obj'\nsmooth = true\n[materials.default]\nalbedo = 0.5\n");
  for (const char* levels : {"subdivide=0", "subdivide=2"}) {
    INFO(levels);
    const Mesostructure from_image = read_mesostructure(image_file, {levels});
    const Mesostructure from_obj = read_mesostructure(obj_file, {levels});
    REQUIRE(from_image.mesh.triangles.size() == from_obj.mesh.triangles.size());
    double positions = 0;
    double normals = 0;
    for (std::size_t t = 0; t < from_image.mesh.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t a = from_image.mesh.triangles[t][k];
        const std::uint32_t b = from_obj.mesh.triangles[t][k];
        positions = std::max<double>(
            positions, (from_image.mesh.positions[a] - from_obj.mesh.positions[b]).length());
        normals = std::max<double>(
            normals, (from_image.mesh.normals[a] - from_obj.mesh.normals[b]).length());
      }
    }
    CHECK(positions < 1e-7);
    CHECK(normals < 1e-6);
  }
}

TEST_CASE("the pit of the tests is half a sphere in a rim that fills the tile") {
  const TemporaryFolder folder;
  write_file(folder, "pit.obj", hemispherical_pit_obj(0.4, 256, 64));
  const Mesostructure m = read_mesostructure(write_file(
      folder, "pit.toml", "type = 'mesh'\nfile = 'pit.obj'\n[materials.default]\nalbedo = 0.5\n"));
  std::map<std::string, double> areas;
  for (std::size_t i = 0; i < m.mesh.triangles.size(); ++i) {
    const auto& t = m.mesh.triangles[i];
    const Vec3& p = m.mesh.positions[t[0]];
    const Vec3 normal = (m.mesh.positions[t[1]] - p).cross(m.mesh.positions[t[2]] - p) / 2.0F;
    const std::string& name = m.mesh.material_names[m.mesh.materials[i]];
    areas[name] += normal.length();
    // All faces look up or to the pit's axis.
    CHECK(normal.dot(Vec3(0.5F, 0.5F, 0.5F) - p) >= 0);
  }
  CHECK(areas["pit"] == Approx(2 * std::numbers::pi * 0.16).epsilon(3e-4));
  CHECK(areas["rim"] == Approx(1 - std::numbers::pi * 0.16).epsilon(3e-4));
  CHECK(m.reference_height == 0);
}
