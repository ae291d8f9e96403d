#include "benchmark_progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "perch/io/message.hpp"

namespace perch::app {

BenchmarkProgress::BenchmarkProgress(std::size_t runs, const std::vector<BenchmarkRun>& open,
                                     const std::vector<EvaluatedScene>& scenes, std::size_t processes,
                                     bool quiet)
    : runs_(runs),
      processes_(processes),
      scenes_(scenes),
      bar_(!quiet && isatty(STDERR_FILENO) != 0),
      lines_(!quiet && !bar_ && processes > 1),
      done_(runs - open.size()) {
  for (const BenchmarkRun& run : open) ++left_[run.method];
}

BenchmarkProgress::~BenchmarkProgress() {
  if (bar_) fmt::print(stderr, "\r\033[K");
}

void BenchmarkProgress::started(const BenchmarkRun& run) {
  const std::lock_guard lock(mutex_);
  running_.push_back(label(run));
  show();
}

void BenchmarkProgress::finished(const BenchmarkRun& run, double seconds) {
  const std::lock_guard lock(mutex_);
  running_.erase(std::remove(running_.begin(), running_.end(), label(run)), running_.end());
  remaining_.took(run.method, seconds);
  --left_[run.method];
  ++done_;
  show();
}

std::string BenchmarkProgress::label(const BenchmarkRun& run) const {
  return name(run.method) + " on " + one_line(scenes_[run.scene].name);
}

void BenchmarkProgress::show() {
  constexpr double line_every = 10.0;  // s
  if (running_.empty() || !(bar_ || (lines_ && since_line_.seconds() >= line_every))) return;
  const auto seconds = remaining_.of(left_, processes_);
  const std::string line =
      fmt::format("{} of {}, {}: {}{}", done_, runs_,
                  seconds ? duration(*seconds) + " left" : std::string("time left unknown"), running_.front(),
                  running_.size() == 1 ? "" : fmt::format(" and {} more", running_.size() - 1));
  if (bar_) {
    constexpr std::size_t width = 30;
    const std::size_t full = runs_ == 0 ? width : width * done_ / runs_;
    fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {}", "", full, "", width - full, line);
  } else {
    fmt::print(stderr, "perch: {}\n", line);
    since_line_ = Stopwatch();
  }
}

}  // namespace perch::app
