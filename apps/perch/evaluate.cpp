#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>

#include "command.hpp"
#include "evaluated_scenes.hpp"
#include "evaluation.hpp"
#include "perch/eval/report.hpp"
#include "perch/eval/tables.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

struct EvaluateOptions {
  std::vector<std::string> scenes, results;
  std::string output;
  bool quiet = false, objects = false;
  SettingsOptions settings;
};

int evaluate(const EvaluateOptions& options) {
  const auto executor = make_executor(options.settings.read().threads);
  const std::vector<EvaluatedScene> scenes = find_scenes(options.scenes);
  const std::vector<ResultFolder> folders = result_folders(options.results);
  if (!options.output.empty()) rehearse_evaluation(options.output);

  const bool progress = !options.quiet && isatty(STDERR_FILENO) != 0;
  const std::vector<MethodRecord> methods =
      evaluate_results(scenes, folders, options.settings, *executor, [&](std::size_t i) {
        if (progress)
          fmt::print(stderr, "\r\033[K{} of {}: {}", i + 1, scenes.size(), one_line(scenes[i].name));
      });
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
