#include "perch/localize/prepare.hpp"

#include "perch/localize/localize.hpp"
#include "perch/localize/raw_scene.hpp"
#include "perch/localize/reach.hpp"
#include "perch/localize/symmetry_search.hpp"

namespace perch {
namespace {

/// Finds the symmetries that are asked for, and gives them to the truth poses that take their model's.
void find_symmetries(Scene& scene, double delta, const Executor& executor) {
  executor.for_each(
      scene.models.size(),
      [&](std::size_t i, std::size_t) {
        SceneModel& model = scene.models[i];
        if (!model.find_symmetry) return;
        model.symmetry = find_symmetry(model.mesh, delta).symmetry;
        model.find_symmetry = false;
      },
      StopCondition());
  for (TruthPose& truth : scene.truth)
    if (truth.has_models_symmetry) truth.symmetry = scene.models[truth.model].symmetry;
}

}  // namespace

Scene prepare(Scene scene, const Settings& settings, const Executor& executor) {
  settings.check();
  find_symmetries(scene, settings.candidates.cost.delta, executor);
  if (scene.background == Background::table) return without_table(std::move(scene), settings.plane);
  // What no object reaches is no object's. It may still hide one.
  if (scene.clutter) {
    scene.table_height = table_height(scene);
    scene.mask = readings_in_reach(scene, *scene.table_height, reading_noise);
  }
  return scene;
}

}  // namespace perch
