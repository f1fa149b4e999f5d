// The window, on an X server without a screen.

#include "gl_preview/window.h"

#include <filesystem>

#include "btf/error.h"
#include "images/image_file.h"
#include "tests/gl_preview/gl_or_skip.h"
#include "tests/gl_preview/test_scenes.h"
#include "tests/gl_preview/virtual_display.h"
#include "tests/temporary_folder.h"

using namespace weft;

namespace {

Scene lit_quad(float albedo) {
  Scene scene = quad_scene(std::make_shared<LambertAppearance>(Rgb(albedo, albedo, albedo)));
  scene.directional_lights = {{{0, 0, 1}, {1, 1, 1}}};
  return scene;
}

}  // namespace

TEST_CASE("Without a display the window ends in a sentence that names --headless") {
  const ScopedVariable no_display("DISPLAY", "");
  const ScopedVariable no_wayland("WAYLAND_DISPLAY", "");
  std::vector<PreviewPane> panes;
  panes.push_back({"one", lit_quad(0.5F)});
  try {
    preview_window(std::move(panes), {});
    FAIL("a window opened without a display");
  } catch (const Error& error) {
    CHECK(error.kind() == Error::Kind::failed);
    CHECK_THAT(error.what(), Catch::Contains("no display") && Catch::Contains("--headless"));
  }
}

TEST_CASE("Two datasets are shown side by side with an error map") {
  // Opened and left again: Mesa's driver stays loaded to the end, where the leak sanitizer looks.
  if (!gl_or_skip()) return;
  const auto display = VirtualDisplay::start();
  if (!display) {
    WARN("skipped: Xvfb is not there");
    return;
  }
  const TemporaryFolder folder;
  const auto file = folder.path / "window.png";
  std::vector<PreviewPane> panes;
  panes.push_back({"bright", lit_quad(0.8F)});
  panes.push_back({"dark", lit_quad(0.2F)});
  for (PreviewPane& pane : panes) {
    pane.scene.camera.width = 300;
    pane.scene.camera.height = 300;
  }
  const WindowResult result = preview_window(std::move(panes), {0.0F, 3, file});
  CHECK(result.frames == 3);
  REQUIRE(result.ms_per_frame.size() == 2);
  CHECK(result.ms_per_frame[0] > 0);
  CHECK(result.bytes[0] > 0);

  const Image shot = read_image(file, Encoding::linear);
  REQUIRE(shot.width > 600);
  // The quad's centre is in the middle of each pane: bright, dark, and the colour of a large error.
  const int y = shot.height / 2;
  const Rgb bright = shot.rgb(shot.width / 6, y);
  const Rgb dark = shot.rgb(shot.width / 2, y);
  const Rgb error = shot.rgb(5 * shot.width / 6, y);
  // sRGB of 0.8 / pi is 0.54, of 0.2 / pi 0.28.
  CHECK(bright.x == Approx(0.54).margin(0.02));
  CHECK(dark.x == Approx(0.28).margin(0.02));
  CHECK(error.y > error.z + 0.3F);
}
