#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <set>

#include "command.hpp"
#include "evaluated_scenes.hpp"
#include "perch/eval/report.hpp"
#include "perch/eval/scene_evaluator.hpp"
#include "perch/eval/tables.hpp"
#include "perch/eval/visible_fractions.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/localize/localize.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions {
  std::vector<std::string> scenes, results;
  std::string output;
  bool quiet = false, objects = false;
  SettingsOptions settings;
};

/// The flat J as the result counts it, unless the command line says otherwise.
CostOf cost_of(const Scene& scene, const std::string& result_file, const ReportedResult& result,
               const EvaluateOptions& options, const Executor& executor) {
  const Settings settings = blaming(result_file + ": guarantee", [&] {
    Settings stated;
    set_field(stated, "cost.missing_depth", result.guarantee.missing_depth);
    stated.candidates.cost.delta = result.guarantee.delta;
    stated.check();
    return options.settings.read(stated);
  });
  return [&scene, &executor, settings](const std::vector<std::vector<PlacedModel>>& arrangements) {
    std::vector<std::int64_t> costs;
    for (const ScoreRecord& record : score(scene, arrangements, settings, executor))
      costs.push_back(record.cost.cost);
    return costs;
  };
}

/// Adds what every method made of one scene.
void evaluate_scene(const EvaluatedScene& evaluated, const std::vector<ResultFolder>& folders,
                    const EvaluateOptions& options, const Executor& executor,
                    std::vector<MethodRecord>& methods) {
  const Scene scene = read_scene(evaluated.file);
  if (scene.truth.empty())
    throw InputError(fmt::format("{}: truth: is missing; give the true poses, or leave out this scene",
                                 shown(evaluated.file)));
  auto visible = read_visible_fractions(evaluated.file, scene);
  const double table = blaming(evaluated.file.string(), [&] { return table_height(scene); });
  const SceneEvaluator evaluator(scene, evaluated.name, table, std::move(visible));
  for (std::size_t m = 0; m < folders.size(); ++m) {
    const auto file = result_of(evaluated, folders[m].folder);
    if (!file) {
      methods[m].scenes.push_back(evaluator.missing());
      continue;
    }
    const ReportedResult result = read_result(*file, scene);
    const CostOf costs = cost_of(scene, file->string(), result, options, executor);
    methods[m].scenes.push_back(
        blaming(evaluated.file.string(), [&] { return evaluator.evaluate(result, costs); }));
  }
}

int evaluate(const EvaluateOptions& options) {
  const auto executor = make_executor(options.settings.read().threads);
  const std::vector<EvaluatedScene> scenes = find_scenes(options.scenes);
  const std::vector<ResultFolder> folders = result_folders(options.results);
  if (!options.output.empty()) rehearse_evaluation(options.output);

  std::vector<MethodRecord> methods;
  for (const ResultFolder& folder : folders) methods.push_back({folder.method, {}});
  const bool progress = !options.quiet && isatty(STDERR_FILENO) != 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (progress) fmt::print(stderr, "\r\033[K{} of {}: {}", i + 1, scenes.size(), one_line(scenes[i].name));
    evaluate_scene(scenes[i], folders, options, *executor, methods);
  }
  if (progress) fmt::print(stderr, "\r\033[K");

  std::vector<MethodSummary> summaries;
  for (const MethodRecord& method : methods) summaries.push_back(summarize(method));
  if (!options.output.empty()) {
    const std::string no_figures = write_evaluation(options.output, methods, summaries);
    if (!no_figures.empty()) fmt::print(stderr, "perch: {}\n", no_figures);
  }
  if (options.objects) fmt::print("{}\n", object_table(methods));
  if (!options.quiet) fmt::print("{}", summary_table(summaries));
  return exit_solved;
}

}  // namespace

void add_evaluate(CLI::App& app, Run& run) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "hold results against the truth of their scenes");
  command->footer(
      "The result of FOLDER/NAME/scene.yaml is DIR/NAME/result.json. Exit status: 0 evaluated, whatever the "
      "results are worth; 2 bad usage or input.");
  command
      ->add_option("scenes", options->scenes,
                   "scene files with truth, or folders whose subfolders hold a scene.yaml")
      ->required();
  command
      ->add_option("--results", options->results,
                   "DIR or NAME=DIR: folder with the results of one method; may be given several times")
      ->required()
      ->allow_extra_args(false);
  command->add_option("-o,--output", options->output,
                      "folder for evaluation.json, objects.csv, thresholds.csv and figures (PNG and SVG)");
  command->add_flag("--objects", options->objects, "print a line for each object");
  command->add_flag("-q,--quiet", options->quiet, "no progress line and no summary");
  options->settings.add_to(*command, {{"--delta", "cost.delta"}, {"--threads", "threads"}});
  command->callback([options, &run] { run = [options] { return evaluate(*options); }; });
}

}  // namespace perch::app
