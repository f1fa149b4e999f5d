// A GLFW window with an OpenGL 4.5 context and Dear ImGui in it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "images/image.h"

namespace weft {

class GuiWindow {
 public:
  /// Its context is current from here on. @throws Error failed, where there is no display or no
  /// OpenGL 4.5.
  GuiWindow(int width, int height, const std::string& title);
  ~GuiWindow();
  GuiWindow(const GuiWindow&) = delete;
  GuiWindow& operator=(const GuiWindow&) = delete;

  /// Runs `contents` (ImGui calls) over the whole window and shows the frame. @param wait  first
  /// waits for input, at most a tenth of a second. @returns false when the user closed the window.
  bool frame(bool wait, const std::function<void()>& contents);

  /// The pixels shown last, 0..1 as on the screen, rows from the top.
  Image screenshot() const;

 private:
  struct Glfw;
  struct Gui;
  std::unique_ptr<Glfw> glfw_;
  std::unique_ptr<Gui> gui_;
};

}  // namespace weft
