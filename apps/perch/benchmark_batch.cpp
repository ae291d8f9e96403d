#include "benchmark_batch.hpp"

#include <fmt/format.h>

#include <system_error>

#include "command.hpp"
#include "output.hpp"
#include "perch/core/error.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/io/message.hpp"
#include "perch/localize/packed_scene.hpp"
#include "run_method.hpp"
#include "scene_input.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

/// The files of a result. Throws Interrupted where `stop` struck before it was found.
OutputSet run_on(const fs::path& file, const Settings& settings, const Executor& own,
                 const StopCondition& stop) {
  const Scene scene = read_prepared_scene(file, settings, own);
  const Result result = blaming(file.string(), [&] {
    learn_models(scene, settings, own);
    return run_method(scene, settings, own, StopCondition::within(stop, settings.time_limit), {});
  });
  // What was broken off is no result.
  if (stop()) throw Interrupted();
  return make_outputs(scene, result, settings, own);
}

class BenchmarkService final : public Service {
 public:
  void hear(ByteReader& common, const Executor& executor, const StopCondition&) override {
    settings_ = read_settings(common);
    executor_ = &executor;
  }
  void answer(ByteReader& question, std::size_t, const StopCondition& stop, ByteWriter& answer) override {
    Settings settings = settings_;
    question.read(settings.localization);
    const fs::path file = question.text();
    // Two machines may run programs of one version that are built with different methods.
    check_built(settings.localization);
    std::error_code error;
    if (!fs::exists(file, error))
      throw InputError(fmt::format("{}: no such file here; put the scenes at the same place on all machines",
                                   shown(file)));
    const Stopwatch watch;
    const OutputSet outputs = run_on(file, settings, *executor_, stop);
    answer.value(watch.seconds());
    answer.count(outputs.files().size());
    for (const auto& [name, bytes] : outputs.files()) {
      answer.text(name);
      answer.text(bytes);
    }
  }

 private:
  Settings settings_;
  const Executor* executor_ = nullptr;
};

}  // namespace

void BenchmarkBatch::work(std::size_t item, std::size_t) {
  const BenchmarkRun& run = runs_[item];
  progress_.started(run);
  const Stopwatch watch;
  Settings settings = settings_;
  settings.localization = run.method;
  write_outputs(run_on(file_of(item), settings, own_, given_up_), run.folder);
  progress_.finished(run, watch.seconds());
}

void BenchmarkBatch::write_common(ByteWriter& to) const {
  write_settings(to, settings_);
}

void BenchmarkBatch::write_question(std::size_t item, ByteWriter& question) const {
  progress_.started(runs_[item]);
  question.value(runs_[item].method);
  // The other process may have been started in another folder.
  question.text(fs::absolute(file_of(item)).string());
}

void BenchmarkBatch::read_answer(std::size_t item, ByteReader& answer) {
  const auto seconds = answer.value<double>();
  OutputSet outputs;
  for (std::uint64_t left = answer.count(); left > 0; --left) {
    std::string name = answer.text();
    outputs.add(std::move(name), answer.text());
  }
  write_outputs(outputs, runs_[item].folder);
  progress_.finished(runs_[item], seconds);
}

std::shared_ptr<Service> make_benchmark_service() {
  return std::make_shared<BenchmarkService>();
}

}  // namespace perch::app
