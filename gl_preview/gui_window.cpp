// GLFW and ImGui set up and torn down.

#include "gl_preview/gui_window.h"

#include <epoxy/gl.h>
// After epoxy, which must be the first to declare OpenGL.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <cstdint>
#include <vector>

#include "btf/error.h"
#include "gl_preview/gl_context.h"

namespace weft {

namespace {

std::string glfw_reason() {
  const char* reason = nullptr;
  glfwGetError(&reason);
  return reason ? reason : "GLFW does not say why";
}

constexpr const char* window_hint = "use --headless -o FILE.exr for a picture without a display";

}  // namespace

struct GuiWindow::Glfw {
  GLFWwindow* window = nullptr;

  Glfw(int width, int height, const std::string& title) {
    if (glfwInit() == GLFW_FALSE) {
      throw failed("preview", "no display to open a window on (" + glfw_reason() + ")",
                   window_hint);
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_OPENGL_DEBUG_CONTEXT, GLFW_TRUE);
    window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!window) {
      const std::string reason = glfw_reason();
      glfwTerminate();
      throw failed("preview", "this display gives no OpenGL 4.5 window (" + reason + ")",
                   window_hint);
    }
    glfwMakeContextCurrent(window);
    glfwSwapInterval(1);
    start_gl_error_log();
  }
  ~Glfw() {
    glfwDestroyWindow(window);
    glfwTerminate();
  }
  Glfw(const Glfw&) = delete;
  Glfw& operator=(const Glfw&) = delete;
};

struct GuiWindow::Gui {
  explicit Gui(GLFWwindow* window) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;  // leaves no imgui.ini where it was started
    ImGui::StyleColorsDark();
    ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450 core");
  }
  ~Gui() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
  }
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;
};

GuiWindow::GuiWindow(int width, int height, const std::string& title)
    : glfw_(std::make_unique<Glfw>(width, height, title)),
      gui_(std::make_unique<Gui>(glfw_->window)) {}

GuiWindow::~GuiWindow() = default;

bool GuiWindow::draw(bool wait, const std::function<void()>& contents) {
  if (wait) {
    glfwWaitEventsTimeout(0.1);
  } else {
    glfwPollEvents();
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
  ImGui::Begin("weft", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus);
  contents();
  ImGui::End();
  ImGui::Render();
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(glfw_->window, &width, &height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  check_gl("drawing the window");
  return glfwWindowShouldClose(glfw_->window) == GLFW_FALSE &&
         glfwGetKey(glfw_->window, GLFW_KEY_ESCAPE) != GLFW_PRESS;
}

void GuiWindow::show() {
  glfwSwapBuffers(glfw_->window);
}

Image GuiWindow::pixels() const {
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(glfw_->window, &width, &height);
  std::vector<std::uint8_t> bytes(std::size_t{3} * width * height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glReadBuffer(GL_BACK);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bytes.data());
  check_gl("screenshot");
  Image image(width, height);
  const std::size_t row = std::size_t{3} * width;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t y = i / row;
    image.values[(height - 1 - y) * row + i % row] = static_cast<float>(bytes[i]) / 255.0F;
  }
  return image;
}

}  // namespace weft
