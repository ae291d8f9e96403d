#include "perch/localize/setup.hpp"

#include <algorithm>
#include <optional>

#include "perch/core/error.hpp"
#include "perch/localize/localize.hpp"

namespace perch {

double table_height(const Scene& scene) {
  if (scene.table_height) return *scene.table_height;
  const Observation observation(scene.camera, scene.depth, scene.mask);
  std::vector<double> heights;
  heights.reserve(observation.size());
  for (const Eigen::Vector3f& p : observation.points())
    heights.push_back((scene.camera.world_from_camera * p.cast<double>()).z());
  // The lowest points lie where objects meet the plane; a few in a hundred are noise below it.
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 200);
  std::nth_element(heights.begin(), low, heights.end());
  return *low;
}

std::unique_ptr<LocalizationProblem> make_problem(const Scene& scene, const Settings& settings,
                                                  const Executor& executor, const StopCondition& stop) {
  settings.check();
  Observation observation(scene.camera, scene.depth, scene.mask);
  const double table = table_height(scene);
  std::vector<std::optional<ObjectModel>> made(scene.models.size());
  if (!executor.for_each(
          made.size(),
          [&](std::size_t i, std::size_t) {
            const SceneModel& model = scene.models[i];
            made[i].emplace(model.name, model.mesh, model.symmetry, table + model.base,
                            settings.candidates.cost.delta);
          },
          stop))
    throw Interrupted();
  std::vector<ObjectModel> models;
  for (auto& model : made) models.push_back(std::move(*model));
  return std::make_unique<LocalizationProblem>(std::move(observation), std::move(models), scene.objects,
                                               scene.workspace, settings.candidates, executor, stop);
}

}  // namespace perch
