#include "evaluation.hpp"

#include <fmt/format.h>

#include "perch/eval/scene_evaluator.hpp"
#include "perch/eval/visible_fractions.hpp"
#include "perch/localize/localize.hpp"
#include "scene_input.hpp"

namespace perch::app {
namespace {

/// The flat J as the result counts it, unless the command line says otherwise.
CostOf cost_of(const Scene& scene, const std::string& result_file, const ReportedResult& result,
               const SettingsOptions& options, const Executor& executor) {
  const Settings settings = blaming(result_file + ": guarantee", [&] {
    Settings stated;
    set_field(stated, "cost.missing_depth", result.guarantee.missing_depth);
    stated.candidates.cost.delta = result.guarantee.delta;
    if (const auto& clutter = result.guarantee.clutter) {
      stated.candidates.cost.clutter_weight = clutter->weight;
      set_field(stated, "cost.clutter_points", clutter->points);
    }
    stated.check();
    return options.read(stated);
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
                    const SettingsOptions& options, const Executor& executor,
                    std::vector<MethodRecord>& methods) {
  const Scene scene = read_scene_with_truth(evaluated.file, options.read(), executor);
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

}  // namespace

Scene read_scene_with_truth(const std::filesystem::path& file, const Settings& settings,
                            const Executor& executor) {
  Scene scene = read_prepared_scene(file, settings, executor);
  if (scene.truth.empty())
    throw InputError(
        fmt::format("{}: truth: is missing; give the true poses, or leave out this scene", shown(file)));
  return scene;
}

std::vector<MethodRecord> evaluate_results(const std::vector<EvaluatedScene>& scenes,
                                           const std::vector<ResultFolder>& folders,
                                           const SettingsOptions& settings, const Executor& executor,
                                           const std::function<void(std::size_t)>& on_scene) {
  std::vector<MethodRecord> methods;
  for (const ResultFolder& folder : folders) methods.push_back({folder.method, {}});
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (on_scene) on_scene(i);
    evaluate_scene(scenes[i], folders, settings, executor, methods);
  }
  return methods;
}

}  // namespace perch::app
