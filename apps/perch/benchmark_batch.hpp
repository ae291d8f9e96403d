#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "benchmark_plan.hpp"
#include "benchmark_progress.hpp"
#include "evaluated_scenes.hpp"
#include "perch/core/stop.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/batch.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// Runs of a benchmark, each made by one process with all its threads. Another process reads the scene by
/// itself, at the same place as here, and says what files come out; all of them are written here.
class BenchmarkBatch final : public Batch {
 public:
  static constexpr const char* service = "benchmark";

  /// Keeps references. \param own this process's threads.
  BenchmarkBatch(const std::vector<BenchmarkRun>& runs, const std::vector<EvaluatedScene>& scenes,
                 const Settings& settings, const Executor& own, BenchmarkProgress& progress)
      : runs_(runs), scenes_(scenes), settings_(settings), own_(own), progress_(progress) {}

  std::size_t size() const override { return runs_.size(); }
  std::string topic() const override { return service; }
  bool fills_process() const override { return true; }
  void work(std::size_t item, std::size_t worker) override;
  void write_common(ByteWriter& to) const override;
  void write_question(std::size_t item, ByteWriter& question) const override;
  void read_answer(std::size_t item, ByteReader& answer) override;
  void give_up() override { given_up_.cancel(); }

 private:
  const std::filesystem::path& file_of(std::size_t item) const { return scenes_[runs_[item].scene].file; }

  const std::vector<BenchmarkRun>& runs_;
  const std::vector<EvaluatedScene>& scenes_;
  const Settings& settings_;
  const Executor& own_;
  BenchmarkProgress& progress_;
  StopCondition given_up_;
};

/// What a process does that shares in the benchmark that another runs.
std::shared_ptr<Service> make_benchmark_service();

}  // namespace perch::app
