#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "perch/core/stopwatch.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/parallel/serve.hpp"

namespace perch {

/// What a batch asked for and what that took, seconds of one thread.
struct RecordedBatch {
  struct Item {
    double home = 0.0;
    double write = 0.0;   ///< to write the question
    double answer = 0.0;  ///< to answer it
    double read = 0.0;    ///< to take the answer in
    std::uint32_t question_bytes = 0, answer_bytes = 0;
  };
  std::string topic;
  std::size_t grain = 1;
  double before_news = 0.0;      ///< what the first process did alone since the last batch until it told news
  double before = 0.0;           ///< and after that
  std::uint64_t news_bytes = 0;  ///< told to all since then
  double hear_news = 0.0;        ///< and what others made of it
  std::uint64_t common_bytes = 0;
  double hear_common = 0.0;
  std::vector<Item> items;
};

/// A run of a program on one thread that asked its services for everything.
struct RecordedRun {
  std::vector<RecordedBatch> batches;
  double after = 0.0;  ///< what the first process did alone after the last batch
};

/// One thread whose batches all go through services in the same process, as they would through another's.
class RecordingExecutor final : public Executor {
 public:
  explicit RecordingExecutor(Services services) : services_(std::move(services)) {}

  std::size_t workers() const override { return 1; }
  bool for_each(std::size_t n, const Body& body, const StopCondition& stop) const override {
    return own_.for_each(n, body, stop);
  }
  bool spread(Batch& batch, const StopCondition& stop) const override;
  /// Pretended, so that all that others need is told.
  std::size_t processes() const override { return 2; }
  void tell(const std::string& topic, Bytes what) const override;

  /// All up to now.
  RecordedRun run() const;

 private:
  SerialExecutor own_;
  Services services_;
  mutable RecordedRun run_;
  mutable RecordedBatch next_;
  mutable Stopwatch watch_;  ///< since the last batch
};

}  // namespace perch
