// Pictures for a screen: what their pixels are, where that is known.
#include "gl_preview/display_pass.h"

#include <array>
#include <cstdint>
#include <vector>

#include "tests/gl_preview/gl_or_skip.h"

using namespace weft;

namespace {

using Pixel = std::array<std::uint8_t, 4>;

std::vector<Pixel> pixels_of(const RenderTarget& target) {
  std::vector<Pixel> pixels(static_cast<std::size_t>(target.width() * target.height()));
  target.bind();
  glReadPixels(0, 0, target.width(), target.height(), GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  return pixels;
}

void check_near(const Pixel& found, const Pixel& expected) {
  for (std::size_t c = 0; c < 4; ++c) CHECK(std::abs(found[c] - expected[c]) <= 1);
}

}  // namespace

TEST_CASE("The legend has the colours of compared pictures' maps, from dark to bright") {
  const auto context = gl_or_skip();
  if (!context) return;
  const RenderTarget target(256, 1, GL_RGBA8);
  DisplayPass().show_legend(target);
  const std::vector<Pixel> pixels = pixels_of(target);
  // OKLab (Ottosson 2020) of L = 0.25 + 0.67 t on the scale's helix, at t = (i + 1/2) / 256.
  check_near(pixels[0], {51, 2, 78, 255});
  check_near(pixels[64], {40, 78, 122, 255});
  check_near(pixels[128], {33, 142, 131, 255});
  check_near(pixels[192], {128, 196, 104, 255});
  check_near(pixels[255], {245, 235, 37, 255});
}

TEST_CASE("An error map has the legend's colour of its difference") {
  const auto context = gl_or_skip();
  if (!context) return;
  const auto filled = [](float value) {
    GlTextureName<GL_TEXTURE_2D> texture = picture_texture(2, 1, GL_RGBA32F);
    const std::array<float, 8> values{value, value, value, 1, 1, 1, 1, 1};
    glTextureSubImage2D(texture.name(), 0, 0, 0, 2, 1, GL_RGBA, GL_FLOAT, values.data());
    return texture;
  };
  const auto reference = filled(1);
  const auto test = filled(1.5F - 1.0F / 512);  // |difference| at 127.5 / 256 of the full scale
  const RenderTarget target(2, 1, GL_RGBA8);
  const RenderTarget legend(256, 1, GL_RGBA8);
  const DisplayPass pass;
  pass.show_error(reference.name(), test.name(), 1, target);
  pass.show_legend(legend);
  check_near(pixels_of(target)[0], pixels_of(legend)[127]);
  check_near(pixels_of(target)[1], {51, 2, 77, 255});  // none at all
}
