// Progress of long work: done, rate and remaining time on a terminal's stderr, and nothing in a
// pipe; what it has to report at its end; and where it keeps what an interrupted run continues
// from.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace weft {

class Progress {
 public:
  /// Silent.
  Progress() = default;
  /// Shows a line "LABEL  42 %  3.1 UNIT/s  8 s left  NOTE" when stderr is a terminal; with work,
  /// "3.1 UNIT/s  1.2e+07 WORK/s".
  explicit Progress(std::string label, bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Begins a stage of `total` steps; `unit` names what a step is (views, texels, iterations), and
  /// `work_unit`, where not empty, what is counted beside it (rays).
  void start(std::int64_t total, std::string unit, std::string work_unit = {});
  /// Thread-safe; cheap enough for a call a millisecond.
  void advance(std::int64_t steps, std::int64_t work = 0);
  /// Shown at the end of the line from now on: the error so far. Thread-safe.
  void note(std::string text);
  /// What was noted last, since the stage began.
  std::string noted() const;
  /// Clears the line; also done by the destructor.
  void finish();

  /// A number that the work tells beside its result, e.g. fits that fell back; the last of a name
  /// counts. Thread-safe.
  void report(const std::string& name, double value);
  /// What was reported, by name.
  std::map<std::string, double> reported() const;

  /// Long work may keep what is done in `folder`, which is the work's alone.
  void keep_in(std::filesystem::path folder) { folder_ = std::move(folder); }
  /// Empty: nothing is to be kept.
  const std::filesystem::path& kept_in() const { return folder_; }

 private:
  void show();

  std::string label_;
  std::string unit_;
  std::string work_unit_;
  std::string note_;
  std::map<std::string, double> reported_;
  std::filesystem::path folder_;
  bool shown_ = false;
  std::int64_t total_ = 0;
  std::atomic<std::int64_t> done_ = 0;
  std::atomic<std::int64_t> work_ = 0;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
  mutable std::mutex mutex_;
};

}  // namespace weft
