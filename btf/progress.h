// Progress of long work: done, rate and remaining time on a terminal's stderr, and nothing in a
// pipe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace weft {

class Progress {
 public:
  /// Silent.
  Progress() = default;
  /// Shows a line "LABEL  42 %  3.1 UNIT/s  8 s left" when stderr is a terminal; with work, "3.1
  /// UNIT/s  1.2e+07 WORK/s".
  explicit Progress(std::string label, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Begins a stage of `total` steps; `unit` names what a step is (views, texels, iterations), and
  /// `work_unit`, where not empty, what is counted beside it (rays).
  void start(std::int64_t total, std::string unit, std::string work_unit = {});
  /// Thread-safe; cheap enough for a call a millisecond.
  void advance(std::int64_t steps, std::int64_t work = 0);
  /// Clears the line; also done by the destructor.
  void finish();

 private:
  void show();

  std::string label_;
  std::string unit_;
  std::string work_unit_;
  bool shown_ = false;
  std::int64_t total_ = 0;
  std::atomic<std::int64_t> done_ = 0;
  std::atomic<std::int64_t> work_ = 0;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
  std::mutex mutex_;
};

}  // namespace weft
