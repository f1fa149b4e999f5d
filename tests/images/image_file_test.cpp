// Pictures come back as they were written, and what is no picture says so.
#include "images/image_file.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include "btf/error.h"
#include "images/srgb.h"
#include "tests/temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using weft::Encoding;
using weft::Image;

Image ramp(int width, int height, int channels) {
  Image image(width, height, channels);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    image.values[i] = static_cast<float>(i) / static_cast<float>(image.values.size());
  }
  return image;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const weft::Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("EXR keeps every float, NaN and infinity too, for 1 to 4 channels") {
  const TemporaryFolder folder;
  for (int channels = 1; channels <= 4; ++channels) {
    Image image = ramp(7, 5, channels);
    image.values[0] = std::numeric_limits<float>::quiet_NaN();
    image.values[1] = std::numeric_limits<float>::infinity();
    image.values[2] = -3.0e-20F;
    weft::write_image(folder.path / "a.exr", image, Encoding::colour);
    const Image back = weft::read_image(folder.path / "a.exr", Encoding::colour);
    REQUIRE(back.channels == channels);
    REQUIRE(back.width == 7);
    REQUIRE(back.height == 5);
    CHECK(std::isnan(back.values[0]));
    CHECK(std::equal(image.values.begin() + 1, image.values.end(), back.values.begin() + 1));
  }
}

TEST_CASE("Colours under an alpha of zero stay as they are") {
  const TemporaryFolder folder;
  Image image(1, 1, 4);
  image.values = {0.2F, 0.4F, 0.6F, 0.0F};
  for (const std::string name : {"a.png", "a.exr", "a.tif"}) {
    weft::write_image(folder.path / name, image, Encoding::linear);
    const Image back = weft::read_image(folder.path / name, Encoding::linear);
    for (int c = 0; c < 4; ++c) CHECK(back.values[c] == Approx(image.values[c]).margin(1e-6));
  }
}

TEST_CASE("A linear PNG holds the raw bytes and no colour chunk") {
  const TemporaryFolder folder;
  Image image(256, 1, 3);
  for (int x = 0; x < 256; ++x) image.set_rgb(x, 0, weft::Rgb(static_cast<float>(x) / 255.0F));
  weft::write_image(folder.path / "raw.png", image, Encoding::linear);
  const Image back = weft::read_image(folder.path / "raw.png", Encoding::linear);
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    CHECK(std::abs(back.values[i] - image.values[i]) < 1e-6F);
  }
  const std::string bytes = bytes_of(folder.path / "raw.png");
  for (const char* chunk : {"gAMA", "sRGB", "iCCP", "cHRM"}) CHECK_THAT(bytes, !Contains(chunk));
}

TEST_CASE("A PNG for people is sRGB-encoded and decodes to what was meant") {
  const TemporaryFolder folder;
  Image image(1, 1, 3);
  image.set_rgb(0, 0, weft::Rgb(0.2158605F));  // code value 128 / 255
  weft::write_image(folder.path / "a.png", image, Encoding::colour);
  CHECK(weft::read_image(folder.path / "a.png", Encoding::linear).values[0] == Approx(128 / 255.0));
  CHECK(weft::read_image(folder.path / "a.png", Encoding::colour).values[0] == Approx(0.2158605));
}

TEST_CASE("The sRGB curve and its inverse agree, and alpha is not bent by it") {
  for (float v = 0; v <= 1; v += 0.01F)
    CHECK(weft::srgb_decoded(weft::srgb_encoded(v)) == Approx(v).margin(1e-6));
  const TemporaryFolder folder;
  Image image(1, 1, 4);
  image.values = {1, 1, 1, 51 / 255.0F};
  weft::write_image(folder.path / "a.png", image, Encoding::colour);
  CHECK(weft::read_image(folder.path / "a.png", Encoding::colour).values[3] == Approx(0.2));
}

TEST_CASE("Two writes of one picture give the same bytes") {
  const TemporaryFolder folder;
  for (const std::string extension : {".exr", ".png"}) {
    weft::write_image(folder.path / ("a" + extension), ramp(9, 4, 3), Encoding::colour);
    const std::string bytes = bytes_of(folder.path / ("a" + extension));
    weft::write_image(folder.path / ("b" + extension), ramp(9, 4, 3), Encoding::colour);
    CHECK(bytes == bytes_of(folder.path / ("b" + extension)));
  }
}

TEST_CASE("What cannot be read is named with the reason") {
  const TemporaryFolder folder;
  const fs::path missing = folder.path / "missing.exr";
  CHECK_THAT(message_of([&] { weft::read_image(missing, Encoding::linear); }),
             Contains(missing.string()) && Contains("no such file"));
  CHECK_THAT(message_of([&] { weft::read_image(folder.path, Encoding::linear); }),
             Contains("folder"));
  for (const std::string name : {"text.png", "text.exr", "text.xyz"}) {
    std::ofstream(folder.path / name) << "this is not a picture\n";
    CHECK_THAT(message_of([&] { weft::read_image(folder.path / name, Encoding::linear); }),
               Contains(name) && Contains("cannot be read as a picture"));
  }
}

TEST_CASE("A truncated EXR or PNG is refused wherever it was cut") {
  const TemporaryFolder folder;
  for (const std::string extension : {".exr", ".png"}) {
    const fs::path path = folder.path / ("whole" + extension);
    weft::write_image(path, ramp(64, 64, 3), Encoding::linear);
    const std::string bytes = bytes_of(path);
    for (const double part : {0.0, 0.02, 0.3, 0.9}) {
      const fs::path cut = folder.path / ("cut" + extension);
      std::ofstream(cut, std::ios::binary)
          .write(bytes.data(), static_cast<std::streamsize>(part * bytes.size()));
      INFO(cut << " to " << part);
      const std::string message = message_of([&] { weft::read_image(cut, Encoding::linear); });
      CHECK_THAT(message, Contains(cut.string()));
    }
  }
}

TEST_CASE("What cannot be written is named, and nothing is left") {
  const TemporaryFolder folder;
  const Image image = ramp(4, 4, 3);
  CHECK_THAT(message_of([&] { weft::write_image(folder.path / "a.xyz", image, Encoding::linear); }),
             Contains("a.xyz") && Contains(".exr"));
  CHECK_THAT(message_of([&] {
               weft::write_image(folder.path / "none" / "a.png", image, Encoding::linear);
             }),
             Contains("none"));
  CHECK_THAT(message_of([&] {
               weft::write_image(folder.path / "a.hdr", ramp(4, 4, 1), Encoding::linear);
             }),
             Contains("a.hdr"));
  Image nan = image;
  nan.values[3 * 5] = std::numeric_limits<float>::quiet_NaN();
  CHECK_THAT(message_of([&] { weft::write_image(folder.path / "nan.png", nan, Encoding::colour); }),
             Contains("1 values are NaN") && Contains("x 1, y 1"));
  CHECK(fs::is_empty(folder.path));
}
