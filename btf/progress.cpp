#include "btf/progress.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace weft {

namespace {

constexpr auto refresh = std::chrono::milliseconds(200);

}  // namespace

Progress::Progress(std::string label, bool quiet)
    : label_(std::move(label)), shown_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  finish();
}

void Progress::start(std::int64_t total, std::string unit, std::string work_unit) {
  const std::scoped_lock lock(mutex_);
  total_ = total;
  unit_ = std::move(unit);
  work_unit_ = std::move(work_unit);
  note_.clear();
  done_ = 0;
  work_ = 0;
  begin_ = last_ = std::chrono::steady_clock::now();
}

void Progress::advance(std::int64_t steps, std::int64_t work) {
  done_ += steps;
  work_ += work;
  if (!shown_) return;
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock || std::chrono::steady_clock::now() - last_ < refresh) return;
  last_ = std::chrono::steady_clock::now();
  show();
}

void Progress::note(std::string text) {
  const std::scoped_lock lock(mutex_);
  note_ = std::move(text);
}

std::string Progress::noted() const {
  const std::scoped_lock lock(mutex_);
  return note_;
}

void Progress::report(const std::string& name, double value) {
  const std::scoped_lock lock(mutex_);
  reported_[name] = value;
}

std::map<std::string, double> Progress::reported() const {
  const std::scoped_lock lock(mutex_);
  return reported_;
}

void Progress::show() {
  const double seconds = std::chrono::duration<double>(last_ - begin_).count();
  const auto done = static_cast<double>(done_.load());
  const double rate = seconds > 0 ? done / seconds : 0;
  const double left = rate > 0 ? (static_cast<double>(total_) - done) / rate : 0;
  const double percent = total_ > 0 ? 100 * done / static_cast<double>(total_) : 0;
  std::string work;
  if (!work_unit_.empty() && seconds > 0) {
    work = fmt::format("  {:.3g} {}/s", static_cast<double>(work_.load()) / seconds, work_unit_);
  }
  fmt::print(stderr, "\r\033[K{}  {:.0f} %  {:.3g} {}/s{}  {:.0f} s left  {}", label_,
             std::min(percent, 100.0), rate, unit_, work, std::max(left, 0.0), note_);
  std::fflush(stderr);
}

void Progress::finish() {
  const std::scoped_lock lock(mutex_);
  if (shown_ && total_ > 0) fmt::print(stderr, "\r\033[K");
  total_ = 0;
}

}  // namespace weft
