#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "benchmark_batch.hpp"
#include "benchmark_plan.hpp"
#include "benchmark_progress.hpp"
#include "command.hpp"
#include "evaluated_scenes.hpp"
#include "evaluation.hpp"
#include "perch/eval/comparison.hpp"
#include "perch/eval/report.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/read_file.hpp"
#include "ranks.hpp"
#include "run_method.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

struct BenchmarkOptions {
  std::vector<std::string> scenes, methods;
  std::string report;
  bool quiet = false;
  SettingsOptions settings;
};

std::vector<LocalizationMethod> methods_of(const BenchmarkOptions& options) {
  std::vector<LocalizationMethod> methods;
  for (const std::string& method : options.methods) {
    Settings settings;
    blaming("--methods", [&] { set_field(settings, "method", method); });
    check_built(settings.localization);
    if (std::find(methods.begin(), methods.end(), settings.localization) != methods.end())
      throw InvalidSetting(fmt::format("--methods: {} is given twice; leave one", one_line(method)));
    methods.push_back(settings.localization);
  }
  return methods;
}

/// Broken scenes, and those without truth, are refused before hours have gone into the others.
void check_scenes(const std::vector<EvaluatedScene>& scenes, const Settings& settings,
                  const Executor& executor) {
  for (const EvaluatedScene& scene : scenes) read_scene_with_truth(scene.file, settings, executor);
}

void run_all(const std::vector<BenchmarkRun>& runs, const std::vector<EvaluatedScene>& scenes,
             const Settings& settings, const Executor& executor, bool quiet) {
  std::vector<BenchmarkRun> open;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(open),
               [&](const BenchmarkRun& run) { return !is_done(run, scenes[run.scene]); });
  BenchmarkProgress progress(runs.size(), open, scenes, executor.processes(), quiet);
  BenchmarkBatch batch(open, scenes, settings, executor.own(), progress);
  executor.spread(batch, StopCondition());
}

/// The pictures of the scenes that each method solved best and worst, as files of the report.
std::vector<ShownPicture> add_pictures(const std::vector<MethodRecord>& methods, const fs::path& report,
                                       OutputSet& outputs) {
  constexpr std::uintmax_t most_bytes = 1 << 28;
  std::vector<ShownPicture> pictures;
  for (const MethodRecord& method : methods) {
    const std::vector<std::size_t> order = ranked_scenes(method);
    for (const bool best : {true, false}) {
      const SceneRecord& scene = method.scenes[best ? order.front() : order.back()];
      const auto right = std::count_if(scene.objects.begin(), scene.objects.end(), [](const ObjectRecord& o) {
        return o.errors && right_threshold.holds(*o.errors);
      });
      const std::string file = fmt::format("{}_{}.png", best ? "best" : "worst", method.method);
      outputs.add(file, read_file(report / method.method / scene.scene / "picture.png", most_bytes));
      pictures.push_back(
          {file, fmt::format("{} of {}: scene {}, {} of {} objects right", best ? "Best" : "Worst",
                             method.method, scene.scene, right, scene.objects.size())});
    }
  }
  return pictures;
}

void write_report(const std::vector<MethodRecord>& methods, const fs::path& report) {
  std::vector<MethodSummary> summaries;
  for (const MethodRecord& method : methods) summaries.push_back(summarize(method));
  const std::string no_figures = write_evaluation(report, methods, summaries);
  OutputSet outputs;
  std::vector<ShownPicture> pictures;
  if (no_figures.empty())
    pictures = {{"thresholds.png", "Objects recognized at each threshold"},
                {"visibility.png", "Recall against the visible fraction"}};
  else
    fmt::print(stderr, "perch: {}\n", no_figures);
  for (ShownPicture& picture : add_pictures(methods, report, outputs)) pictures.push_back(std::move(picture));
  const std::string introduction = fmt::format(
      "{} scenes with {} objects. Settings are in settings.yaml, every object in objects.csv, the result of "
      "each "
      "run in METHOD/SCENE.",
      summaries.front().scenes, summaries.front().right.objects);
  outputs.add("report.md", comparison_page(introduction, summaries, pictures));
  outputs.commit(report);
  fmt::print("{}", comparison_tables(summaries));
}

int benchmark(const BenchmarkOptions& options, const Ranks& ranks) {
  const Settings settings = options.settings.read();
  settings.check_together();
  if (settings.localization != LocalizationMethod::perch)
    throw InvalidSetting(
        fmt::format("method is {}; name the methods with --methods", name(settings.localization)));
  const std::vector<LocalizationMethod> methods = methods_of(options);
  const std::vector<EvaluatedScene> scenes = find_scenes(options.scenes);
  const auto executor = ranks.executor(settings.threads);
  check_scenes(scenes, settings, *executor);
  const fs::path report = options.report;
  rehearse_evaluation(report);
  keep_settings(settings, report);

  run_all(benchmark_runs(scenes, methods, report), scenes, settings, *executor, options.quiet);
  std::vector<ResultFolder> folders;
  for (const LocalizationMethod method : methods) folders.push_back({name(method), report / name(method)});
  write_report(evaluate_results(scenes, folders, options.settings, *executor), report);
  return exit_solved;
}

}  // namespace

void add_benchmark(CLI::App& app, Run& run, const Ranks& ranks) {
  auto options = std::make_shared<BenchmarkOptions>();
  options->methods = {"perch"};
  CLI::App* command =
      app.add_subcommand("benchmark", "run methods over scenes with truth and compare what they find");
  command->footer(
      "Goes on where it was stopped: a result that is there, and no older than its scene, is kept. Exit "
      "status: "
      "0 done, whatever the results are worth; 2 bad usage or input.");
  command
      ->add_option("scenes", options->scenes,
                   "scene files with truth, or folders whose subfolders hold a scene.yaml")
      ->required();
  command
      ->add_option("--methods", options->methods,
                   "perch, bfwor, ourcvfh, ppf: one or several, separated by commas [perch]")
      ->delimiter(',');
  command->add_option("-o,--output", options->report, "folder for the report and all results")->required();
  command->add_flag("-q,--quiet", options->quiet, "no progress bar, and no lines in its place");
  options->settings.add_to(*command, {{"--w", "search.w"},
                                      {"--delta", "cost.delta"},
                                      {"--resolution", "grid.resolution"},
                                      {"--yaw-resolution-deg", "grid.yaw_resolution_deg"},
                                      {"--time-limit", "search.time_limit"},
                                      {"--threads", "threads"}});
  command->callback(
      [options, &run, &ranks] { run = [options, &ranks] { return benchmark(*options, ranks); }; });
}

}  // namespace perch::app
