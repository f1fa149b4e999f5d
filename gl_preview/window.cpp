// The window's state, what the mouse does to it, and the panes.

#include "gl_preview/window.h"

#include <epoxy/gl.h>
#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>

#include "gl_preview/display_pass.h"
#include "gl_preview/gl_context.h"
#include "gl_preview/gui_window.h"
#include "gl_preview/orbit.h"
#include "images/image_file.h"

namespace weft {

namespace {

constexpr float radians_per_pixel = 0.006F;
constexpr float zoom_per_notch = 0.9F;

/// Sum of |test - reference| and largest difference, over channels.
struct ErrorNumbers {
  double mean = 0;
  double relative = 0;  ///< mean over the reference's mean
  double largest = 0;
};

ErrorNumbers error_numbers(const Image& reference, const Image& test) {
  ErrorNumbers numbers;
  double sum = 0;
  double reference_sum = 0;
  for (std::size_t i = 0; i < reference.values.size(); ++i) {
    const double d = std::abs(static_cast<double>(test.values[i]) - reference.values[i]);
    sum += d;
    reference_sum += reference.values[i];
    numbers.largest = std::max(numbers.largest, d);
  }
  const auto n = static_cast<double>(std::max<std::size_t>(reference.values.size(), 1));
  numbers.mean = sum / n;
  numbers.relative = reference_sum > 0 ? sum / reference_sum : 0;
  return numbers;
}

/// The next of 1, 2, 5, 10, ... at or above `value`.
float round_scale(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power * 1.000001) return static_cast<float>(step * power);
  }
  return static_cast<float>(10 * power);
}

ImTextureID imgui_texture(const RenderTarget& target) {
  return reinterpret_cast<ImTextureID>(static_cast<std::intptr_t>(target.texture()));
}

/// A pane on the GPU.
struct Pane {
  std::string title;
  SceneRenderer renderer;
  RenderTarget shown;
  Image pixels;
  double last_ms = 0;
  double total_ms = 0;
};

class PreviewApp {
 public:
  PreviewApp(std::vector<PreviewPane> panes, const WindowOptions& options)
      : camera_(panes.front().scene.camera),
        lights_(preview_lights(panes.front().scene)),
        continuous_(options.frames > 0),
        automatic_lod_(!options.lod),
        fixed_lod_(options.lod.value_or(0)),
        legend_(256, 1, GL_RGBA8) {
    for (PreviewPane& pane : panes) {
      panes_.push_back({std::move(pane.title), SceneRenderer(pane.scene), {}, {}, 0, 0});
    }
    display_.show_legend(legend_);
  }

  /// One frame's ImGui calls; draws the panes anew where something changed.
  void frame() {
    show_controls();
    const int columns = static_cast<int>(panes_.size()) + (panes_.size() > 1 ? 1 : 0);
    const ImVec2 room = ImGui::GetContentRegionAvail();
    // The title above; below, at most the legend, its numbers, two lines of text and a slider.
    const float around =
        5 * ImGui::GetTextLineHeightWithSpacing() + ImGui::GetFrameHeightWithSpacing();
    const float gap = ImGui::GetStyle().ItemSpacing.x;
    const int width = std::max(16, static_cast<int>((room.x - gap * (columns - 1)) / columns));
    const int height = std::max(16, static_cast<int>(room.y - around));
    resize(width, height);
    if (stale_ || continuous_) draw_panes();
    for (std::size_t i = 0; i < panes_.size(); ++i) {
      if (i > 0) ImGui::SameLine();
      show_pane(i);
    }
    if (panes_.size() > 1) {
      ImGui::SameLine();
      show_error_pane();
    }
  }

  WindowResult result(int frames) const {
    WindowResult result;
    result.frames = frames;
    for (const Pane& pane : panes_) {
      result.ms_per_frame.push_back(drawn_ > 1 ? pane.total_ms / (drawn_ - 1) : 0);
      result.bytes.push_back(pane.renderer.bytes());
    }
    result.renderer = gl_renderer();
    return result;
  }

 private:
  void resize(int width, int height) {
    if (camera_.width == width && camera_.height == height && drawn_ > 0) return;
    camera_.width = width;
    camera_.height = height;
    for (Pane& pane : panes_) pane.shown = RenderTarget(width, height, GL_RGBA8);
    error_ = RenderTarget(width, height, GL_RGBA8);
    stale_ = true;
  }

  void draw_panes() {
    const FixedLod lod = automatic_lod_ ? FixedLod() : FixedLod(fixed_lod_);
    for (Pane& pane : panes_) {
      const auto begin = std::chrono::steady_clock::now();
      pane.renderer.draw(camera_, lights_, lod);
      glFinish();
      pane.last_ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
              .count();
      if (drawn_ > 0) pane.total_ms += pane.last_ms;
      if (panes_.size() > 1) pane.pixels = pane.renderer.read();
    }
    ++drawn_;
    stale_ = false;
    measure_error();
    display();
  }

  void measure_error() {
    if (panes_.size() < 2) return;
    numbers_ = error_numbers(panes_[0].pixels, panes_[compared_].pixels);
    if (!full_scale_) full_scale_ = round_scale(numbers_.largest);
  }

  void display() {
    for (const Pane& pane : panes_) display_.show(pane.renderer.picture(), exposure_, pane.shown);
    if (panes_.size() > 1) {
      display_.show_error(panes_[0].renderer.picture(), panes_[compared_].renderer.picture(),
                          full_scale_.value_or(1), error_);
    }
  }

  void show_controls() {
    ImGui::SetNextItemWidth(160);
    bool redisplay = ImGui::SliderFloat("exposure", &exposure_, -8, 8, "%.1f stops");
    ImGui::SameLine(0, 24);
    stale_ |= ImGui::Checkbox("lod of each pixel", &automatic_lod_);
    if (!automatic_lod_) {
      ImGui::SameLine();
      ImGui::SetNextItemWidth(100);
      stale_ |= ImGui::SliderFloat("lod", &fixed_lod_, 0, 8, "%.1f");
    }
    ImGui::TextUnformatted(
        "drag: orbit    right or shift drag: light    wheel: distance    Esc: quit");
    if (redisplay && drawn_ > 0) display();
  }

  void show_pane(std::size_t index) {
    const Pane& pane = panes_[index];
    ImGui::BeginGroup();
    ImGui::TextUnformatted(pane.title.c_str());
    show_picture(pane.shown, static_cast<int>(index));
    ImGui::TextUnformatted(fmt::format("{:.1f} ms ({:.0f} fps), textures {:.2f} MB", pane.last_ms,
                                       pane.last_ms > 0 ? 1000 / pane.last_ms : 0.0,
                                       static_cast<double>(pane.renderer.bytes()) * 1e-6)
                               .c_str());
    ImGui::EndGroup();
  }

  void show_error_pane() {
    ImGui::BeginGroup();
    ImGui::TextUnformatted(
        fmt::format("|{} - {}|", panes_[compared_].title, panes_[0].title).c_str());
    show_picture(error_, static_cast<int>(panes_.size()));
    const float full = full_scale_.value_or(1);
    const auto width = static_cast<float>(error_.width());
    ImGui::Image(imgui_texture(legend_), {width, ImGui::GetTextLineHeight()});
    show_scale_numbers(width, full);
    show_error_controls(full);
    ImGui::EndGroup();
  }

  static void show_scale_numbers(float width, float full) {
    const float left = ImGui::GetCursorPosX();
    for (int i = 0; i <= 4; ++i) {
      const std::string number = fmt::format("{:.3g}", full * static_cast<float>(i) / 4);
      const float text_width = ImGui::CalcTextSize(number.c_str()).x;
      if (i > 0) ImGui::SameLine();
      ImGui::SetCursorPosX(left + (width - text_width) * static_cast<float>(i) / 4);
      ImGui::TextUnformatted(number.c_str());
    }
  }

  void show_error_controls(float full) {
    ImGui::TextUnformatted(fmt::format("mean {:.3g} ({:.2f} % of the left mean)", numbers_.mean,
                                       100 * numbers_.relative)
                               .c_str());
    ImGui::TextUnformatted(fmt::format("largest {:.3g}", numbers_.largest).c_str());
    ImGui::SetNextItemWidth(100);
    bool redisplay =
        ImGui::SliderFloat("full scale", &full, 1e-4F, 10, "%.4f", ImGuiSliderFlags_Logarithmic);
    if (redisplay) full_scale_ = full;
    if (panes_.size() > 2) {
      ImGui::SameLine();
      int chosen = static_cast<int>(compared_);
      ImGui::SetNextItemWidth(50);
      if (ImGui::SliderInt("pane", &chosen, 1, static_cast<int>(panes_.size()) - 1)) {
        compared_ = static_cast<std::size_t>(chosen);
        measure_error();
        redisplay = true;
      }
    }
    if (redisplay) display();
  }

  /// A picture that listens to the mouse.
  void show_picture(const RenderTarget& picture, int id) {
    const ImVec2 size(static_cast<float>(picture.width()), static_cast<float>(picture.height()));
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    ImGui::PushID(id);
    ImGui::InvisibleButton("picture", size,
                           ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight);
    ImGui::PopID();
    ImGui::GetWindowDrawList()->AddImage(imgui_texture(picture), corner,
                                         {corner.x + size.x, corner.y + size.y});
    const ImGuiIO& io = ImGui::GetIO();
    if (ImGui::IsItemHovered() && io.MouseWheel != 0) {
      camera_ = dollied(camera_, std::pow(zoom_per_notch, io.MouseWheel));
      stale_ = true;
    }
    // Not in the frame of the click itself: its move came before the button, however far it was.
    const bool is_held = ImGui::IsItemActive() && !ImGui::IsItemActivated();
    if (is_held && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) drag(io);
  }

  void drag(const ImGuiIO& io) {
    const float across = io.MouseDelta.x * radians_per_pixel;
    const float down = io.MouseDelta.y * radians_per_pixel;
    // What is under the mouse follows it: the light turns with it, the camera against it.
    if (ImGui::IsMouseDown(ImGuiMouseButton_Right) || io.KeyShift) {
      lights_ = with_first_light_turned(lights_, camera_.target, camera_.up, across, -down);
    } else {
      camera_ = orbited(camera_, -across, down);
    }
    stale_ = true;
  }

  Camera camera_;
  PreviewLights lights_;
  bool continuous_;
  bool automatic_lod_;
  float fixed_lod_;
  float exposure_ = 0;
  std::optional<float> full_scale_;
  std::size_t compared_ = 1;
  ErrorNumbers numbers_;
  bool stale_ = true;
  int drawn_ = 0;
  DisplayPass display_;
  RenderTarget legend_;
  RenderTarget error_;
  std::vector<Pane> panes_;
};

}  // namespace

WindowResult preview_window(std::vector<PreviewPane> panes, const WindowOptions& options) {
  const Camera& camera = panes.front().scene.camera;
  const int columns = static_cast<int>(panes.size()) + (panes.size() > 1 ? 1 : 0);
  const int pane_width = columns > 1 ? std::min(camera.width, 480) : camera.width;
  constexpr int margins = 16;
  constexpr int controls = 190;
  GuiWindow window(columns * (pane_width + margins), std::min(camera.height, pane_width) + controls,
                   "weft preview");
  PreviewApp app(std::move(panes), options);
  int frames = 0;
  for (bool last = false; !last;) {
    // The second frame shows what the first one laid out; after that, only input changes anything.
    const bool wait = options.frames == 0 && frames > 1;
    last = !window.draw(wait, [&] { app.frame(); });
    ++frames;
    last |= frames == options.frames;
    if (last && !options.screenshot.empty()) {
      write_image(options.screenshot, window.pixels(), Encoding::linear);
    }
    window.show();
  }
  return app.result(frames);
}

}  // namespace weft
