#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "benchmark_plan.hpp"
#include "evaluated_scenes.hpp"
#include "perch/core/stopwatch.hpp"

namespace perch::app {

/// `12 of 88` as a bar, what is being run and how long the rest may take, on stderr. Where that is no
/// terminal: silent, or with several processes, whose output passes through mpirun, a line now and then. Told
/// by several threads.
class BenchmarkProgress {
 public:
  /// Keeps a reference to the scenes. \param runs in all. \param open those that are still to be done. \param
  /// processes that run them.
  BenchmarkProgress(std::size_t runs, const std::vector<BenchmarkRun>& open,
                    const std::vector<EvaluatedScene>& scenes, std::size_t processes, bool quiet);
  /// Clears the line.
  ~BenchmarkProgress();
  BenchmarkProgress(const BenchmarkProgress&) = delete;
  BenchmarkProgress& operator=(const BenchmarkProgress&) = delete;

  void started(const BenchmarkRun& run);
  void finished(const BenchmarkRun& run, double seconds);

 private:
  std::string label(const BenchmarkRun& run) const;
  void show();

  const std::size_t runs_, processes_;
  const std::vector<EvaluatedScene>& scenes_;
  const bool bar_, lines_;
  std::mutex mutex_;
  std::size_t done_;
  std::map<LocalizationMethod, std::size_t> left_;  ///< those that are being run among them
  std::vector<std::string> running_;                ///< first the one that was started first
  RemainingTime remaining_;
  Stopwatch since_line_;
};

}  // namespace perch::app
