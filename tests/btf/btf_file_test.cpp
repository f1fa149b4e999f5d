// Datasets on disk: round trips, resumption, and what is refused.
#include "btf/btf_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>

#include "btf/atomic_file.h"
#include "btf/error.h"
#include "btf/random.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

Btf random_btf(PixelType type) {
  Btf btf(3, 2, HemisphereSampling(named_directions("fibonacci:5")),
          HemisphereSampling(named_directions("regular:2x4")), type);
  for (std::size_t v = 0; v < 5; ++v) {
    for (std::size_t l = 0; l < 8; ++l) {
      for (int i = 0; i < 6; ++i) {
        btf.set(l, v, i % 3, i / 3,
                Rgb(unit_float(hash_coordinates(v, l, i)), static_cast<float>(i), 1e-3F));
      }
    }
  }
  btf.provenance = R"({"type":"test"})";
  return btf;
}

BtfHeader header_of(const Btf& btf) {
  return {.width = btf.width(),
          .height = btf.height(),
          .views = btf.views(),
          .lights = btf.lights(),
          .pixel_type = btf.pixel_type(),
          .tile_size = 1,
          .provenance = btf.provenance,
          .standard_errors = {}};
}

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

TEST_CASE("a dataset comes back bit by bit") {
  for (const PixelType type : {PixelType::half, PixelType::float32}) {
    const TemporaryFolder folder;
    const Btf written = random_btf(type);
    write_btf(folder.path / "a.btf", written);
    const Btf read = read_btf(folder.path / "a.btf");
    CHECK(read.width() == 3);
    CHECK(read.height() == 2);
    CHECK(read.pixel_type() == type);
    CHECK(read.provenance == written.provenance);
    for (std::size_t i = 0; i < read.views().size(); ++i)
      CHECK(read.views()[i] == written.views()[i]);
    CHECK(std::equal(read.lights().triangles().begin(), read.lights().triangles().end(),
                     written.lights().triangles().begin()));
    CHECK(std::equal(read.halfs().begin(), read.halfs().end(), written.halfs().begin()));
    CHECK(std::equal(read.floats().begin(), read.floats().end(), written.floats().begin()));
    CHECK(corrupted_files(folder.path / "a.btf").empty());
  }
}

TEST_CASE("writing twice gives the same bytes") {
  const TemporaryFolder folder;
  write_btf(folder.path / "a.btf", random_btf(PixelType::half));
  write_btf(folder.path / "b.btf", random_btf(PixelType::half));
  CHECK(file_checksum(folder.path / "a.btf/view_003.exr") ==
        file_checksum(folder.path / "b.btf/view_003.exr"));
  CHECK(read_text(folder.path / "a.btf/btf.json") == read_text(folder.path / "b.btf/btf.json"));
}

TEST_CASE("a writer continues where another stopped, and keeps the noise") {
  const TemporaryFolder folder;
  const Btf btf = random_btf(PixelType::half);
  const std::vector<float> values(3 * 6 * 8, 0.25F);
  const std::vector<float> errors(8, 0.125F);
  BtfWriter first(folder.path / "a.btf", header_of(btf));
  first.write_view(0, {.values = values, .standard_errors = errors});
  CHECK_THROWS_WITH(first.finish(), Catch::Contains("view_001.exr"));
  CHECK_THROWS_AS(read_btf_header(folder.path / "a.btf"), Error);
  BtfWriter second(folder.path / "a.btf", header_of(btf));
  CHECK(second.has_view(0));
  for (std::size_t v = 1; v < 5; ++v) {
    CHECK_FALSE(second.has_view(v));
    second.write_view(v, {.values = values, .standard_errors = errors});
  }
  second.finish();
  const BtfHeader header = read_btf_header(folder.path / "a.btf");
  REQUIRE(header.standard_errors.size() == 40);
  CHECK(header.standard_errors[17] == 0.125F);
  BtfHeader other = header_of(btf);
  other.provenance = R"({"type":"other"})";
  CHECK_THROWS_WITH(BtfWriter(folder.path / "a.btf", other), Catch::Contains("other settings"));
}

TEST_CASE("a folder is refused to other settings before the first view is there") {
  const TemporaryFolder folder;
  const Btf btf = random_btf(PixelType::half);
  const std::vector<float> values(3 * 6 * 8, 0.25F);
  BtfHeader other = header_of(btf);
  other.provenance = R"({"type":"test","spp":2})";
  BtfWriter first(folder.path / "a.btf", header_of(btf));
  CHECK_THROWS_WITH(BtfWriter(folder.path / "a.btf", other),
                    Catch::Contains("other settings") && Catch::Contains("unfinished.json") &&
                        Catch::Contains("/spp"));
  BtfWriter second(folder.path / "a.btf", header_of(btf));
  for (std::size_t v = 0; v < 5; ++v)
    (v % 2 == 0 ? first : second).write_view(v, {.values = values});
  CHECK_THROWS_WITH(missing_views(folder.path / "a.btf", other), Catch::Contains("other settings"));
  CHECK_THROWS_WITH(finish_btf(folder.path / "a.btf", other), Catch::Contains("other settings"));
  CHECK(names_in(folder.path / "a.btf").back() == "view_004.exr");
  second.finish();
  CHECK(names_in(folder.path / "a.btf") ==
        std::vector<std::string>{"btf.json", "view_000.exr", "view_001.exr", "view_002.exr",
                                 "view_003.exr", "view_004.exr"});
}

TEST_CASE("a dataset takes no place that holds something else") {
  const TemporaryFolder folder;
  const BtfHeader header = header_of(random_btf(PixelType::half));
  const std::filesystem::path codec = folder.path / "a.cmf";
  std::filesystem::create_directory(codec);
  std::ofstream(codec / "codec.json") << "{}";
  std::ofstream(folder.path / "file") << "text";
  CHECK_THROWS_WITH(BtfWriter(codec, header), Catch::Contains("codec.json"));
  CHECK_THROWS_WITH(missing_views(codec, header), Catch::Contains("codec.json"));
  CHECK(names_in(codec) == std::vector<std::string>{"codec.json"});
  CHECK_THROWS_WITH(BtfWriter(folder.path / "file", header), Catch::Contains("is a file"));
  CHECK_THROWS_WITH(BtfWriter("", header), Catch::Contains("no name"));
}

TEST_CASE("a writer that fails removes the folder that it made, unless a view is in it") {
  const TemporaryFolder folder;
  const BtfHeader header = header_of(random_btf(PixelType::half));
  const std::filesystem::path path = folder.path / "a.btf";
  const std::vector<float> good(3 * 6 * 8, 0.25F);
  const std::vector<float> bright(3 * 6 * 8, 1e6F);
  const auto fail = [&](bool after_a_view) {
    BtfWriter writer(path, header);
    if (after_a_view) writer.write_view(1, {.values = good});
    writer.write_view(0, {.values = bright});
  };
  CHECK_THROWS(fail(false));
  CHECK_FALSE(std::filesystem::exists(path));
  std::filesystem::create_directory(path);
  CHECK_THROWS(fail(false));
  CHECK(std::filesystem::exists(path));  // somebody else's
  std::filesystem::remove_all(path);
  CHECK_THROWS(fail(true));
  CHECK(missing_views(path, header) == std::vector<std::size_t>{0, 2, 3, 4});
  std::filesystem::remove_all(path);
  { const BtfWriter idle(path, header); }
  CHECK(std::filesystem::exists(path / "unfinished.json"));
}

TEST_CASE("finishing names what is missing and makes nothing") {
  const TemporaryFolder folder;
  const BtfHeader header = header_of(random_btf(PixelType::half));
  CHECK(missing_views(folder.path / "a.btf", header).size() == 5);
  CHECK_THROWS_WITH(finish_btf(folder.path / "a.btf", header), Catch::Contains("view_000.exr"));
  CHECK(std::filesystem::is_empty(folder.path));
  BtfWriter(folder.path / "a.btf", header)
      .write_view(3, {.values = std::vector<float>(3 * 6 * 8, 0.25F)});
  CHECK(missing_views(folder.path / "a.btf", header) == std::vector<std::size_t>{0, 1, 2, 4});
}

TEST_CASE("values that may not be stored are refused with their place") {
  const TemporaryFolder folder;
  BtfWriter writer(folder.path / "a.btf", header_of(random_btf(PixelType::half)));
  std::vector<float> values(3 * 6 * 8, 1.0F);
  values[3 * (2 * 6 + 4) + 1] = 70000;  // light 2, texel (1, 1)
  CHECK_THROWS_WITH(
      writer.write_view(1, {.values = values}),
      Catch::Contains("view 1, light 2, texel (1, 1)") && Catch::Contains("--pixel float"));
  values[3 * (2 * 6 + 4) + 1] = std::numeric_limits<float>::quiet_NaN();
  CHECK_THROWS_WITH(writer.write_view(1, {.values = values}), Catch::Contains("nan"));
  values[3 * (2 * 6 + 4) + 1] = -1;
  CHECK_THROWS_AS(writer.write_view(1, {.values = values}), Error);
  CHECK_FALSE(writer.has_view(1));
  CHECK(names_in(folder.path / "a.btf") == std::vector<std::string>{"unfinished.json"});
}

TEST_CASE("a view in memory comes back, and takes only what can be stored") {
  Btf btf = random_btf(PixelType::half);
  const std::vector<float> old = btf.view_values(2);
  REQUIRE(old.size() == 3 * 6 * 8);
  const std::size_t sample = 3 * (5 * 6 + 4);  // light 5, texel (1, 1)
  CHECK(Rgb(old[sample], old[sample + 1], old[sample + 2]) == btf.at(5, 2, 1, 1));
  std::vector<float> values(old.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
  btf.set_view(3, values);
  CHECK(btf.view_values(3) == values);
  CHECK(btf.view_values(2) == old);
  CHECK_THROWS_WITH(btf.set_view(0, std::span(values).first(12)), Catch::Contains("144"));
  values[sample] = 70000;
  CHECK_THROWS_WITH(btf.set_view(1, values), Catch::Contains("view 1, light 5, texel (1, 1)") &&
                                                 Catch::Contains("--pixel float"));
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0F}) {
    values[sample] = bad;
    CHECK_THROWS_AS(btf.set_view(1, values), Error);
  }
  values[sample] = 70000;
  Btf floats = random_btf(PixelType::float32);
  floats.set_view(1, values);
  CHECK(floats.at(5, 1, 1, 1).x == 70000);
}

TEST_CASE("a view whose window does not start at (0, 0) is refused") {
  const TemporaryFolder folder;
  const auto path = folder.path / "a.btf" / "view_002.exr";
  write_btf(folder.path / "a.btf", random_btf(PixelType::half));
  std::string bytes = read_text(path);
  const std::string checksum = file_checksum(path);
  // Of the first part: name, type, size, then xMin, yMin, xMax, yMax in little-endian ints.
  const std::string name("dataWindow\0box2i\0\x10\0\0\0", 21);
  const std::size_t window = bytes.find(name) + name.size();
  REQUIRE(window < bytes.size());
  bytes[window] = 1;
  bytes[window + 8] = 3;
  std::ofstream(path, std::ios::binary) << bytes;
  std::string json = read_text(folder.path / "a.btf/btf.json");
  json.replace(json.find(checksum), checksum.size(), file_checksum(path));
  std::ofstream(folder.path / "a.btf/btf.json") << json;
  CHECK_THROWS_WITH(read_btf(folder.path / "a.btf"),
                    Catch::Contains("view_002.exr") && Catch::Contains("starts at (1, 0)"));
}

TEST_CASE("a view that cannot be written is named, not its temporary file") {
  const TemporaryFolder folder;
  BtfWriter writer(folder.path / "a.btf", header_of(random_btf(PixelType::half)));
  std::filesystem::remove_all(folder.path / "a.btf");
  std::ofstream(folder.path / "a.btf") << "a file, which no folder can replace";
  try {
    writer.write_view(2, {.values = std::vector<float>(3 * 6 * 8, 1.0F)});
    FAIL("written into a file");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Catch::Contains("view_002.exr") && !Catch::Contains(".part"));
  }
}

TEST_CASE("damaged datasets are named") {
  const TemporaryFolder folder;
  const auto path = folder.path / "a.btf";
  write_btf(path, random_btf(PixelType::half));
  std::filesystem::copy_file(path / "view_001.exr", path / "view_000.exr",
                             std::filesystem::copy_options::overwrite_existing);
  CHECK_THROWS_WITH(read_btf(path), Catch::Contains("view_000.exr") && Catch::Contains("checksum"));
  std::filesystem::remove_all(path);
  write_btf(path, random_btf(PixelType::half));
  std::filesystem::resize_file(path / "view_002.exr", 2000);
  CHECK(corrupted_files(path) == std::vector<std::string>{"view_002.exr"});
  CHECK_THROWS_WITH(read_btf(path), Catch::Contains("view_002.exr"));
  std::filesystem::remove(path / "view_002.exr");
  CHECK_THROWS_WITH(read_btf(path), Catch::Contains("view_002.exr") && Catch::Contains("missing"));
  std::ofstream(path / "btf.json") << "{\"format\": \"weft-btf\", \"version\": 1";
  CHECK_THROWS_WITH(read_btf(path), Catch::Contains("btf.json") && Catch::Contains("not JSON"));
  CHECK_THROWS_WITH(read_btf(folder.path), Catch::Contains("btf.json"));
  CHECK_THROWS_WITH(read_btf(folder.path / "none"), Catch::Contains("not a BTF dataset"));
}
