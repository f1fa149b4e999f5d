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

  /// Draws a frame: `contents` (ImGui calls) over the whole window. @param wait  first waits for
  /// input, at most a tenth of a second. @returns false when the user closed the window.
  bool draw(bool wait, const std::function<void()>& contents);

  /// The pixels drawn and not yet shown, 0..1 as on the screen, rows from the top.
  Image pixels() const;

  /// Shows what was drawn.
  void show();

 private:
  struct Glfw;
  struct Gui;
  std::unique_ptr<Glfw> glfw_;
  std::unique_ptr<Gui> gui_;
};

}  // namespace weft
