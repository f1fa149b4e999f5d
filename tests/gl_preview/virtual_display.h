// An X server without a screen for one test (Xvfb), and the DISPLAY of what runs in it.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>

/// Sets an environment variable (or unsets it, for an empty value) until it goes.
class ScopedVariable {
 public:
  ScopedVariable(std::string name, const std::string& value) : name_(std::move(name)) {
    const char* old = std::getenv(name_.c_str());
    had_ = old != nullptr;
    if (had_) old_ = old;
    set(value, !value.empty());
  }
  ~ScopedVariable() { set(old_, had_); }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;

 private:
  void set(const std::string& value, bool present) {
    if (present) {
      setenv(name_.c_str(), value.c_str(), 1);
    } else {
      unsetenv(name_.c_str());
    }
  }
  std::string name_;
  std::string old_;
  bool had_ = false;
};

class VirtualDisplay {
 public:
  /// None where Xvfb is not installed or does not start.
  static std::unique_ptr<VirtualDisplay> start() {
    int ends[2];
    if (pipe(ends) != 0) return nullptr;
    const pid_t child = fork();
    if (child == 0) {
      dup2(ends[1], 3);
      const int nothing = open("/dev/null", O_RDWR);
      dup2(nothing, STDERR_FILENO);
      execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "1600x900x24", "-nolisten", "tcp",
             nullptr);
      _exit(127);
    }
    close(ends[1]);
    std::string number;
    char c = 0;
    while (read(ends[0], &c, 1) == 1 && c != '\n') number += c;
    close(ends[0]);
    std::unique_ptr<VirtualDisplay> display(new VirtualDisplay(child, ":" + number));
    return number.empty() ? nullptr : std::move(display);
  }
  ~VirtualDisplay() {
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
  }

 private:
  VirtualDisplay(pid_t server, const std::string& name)
      : server_(server), display_("DISPLAY", name) {}
  pid_t server_;
  ScopedVariable display_;
};
