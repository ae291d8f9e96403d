#include "perch/localize/setup.hpp"

#include <algorithm>
#include <optional>

#include "perch/core/error.hpp"
#include "perch/localize/localize.hpp"
#include "perch/observation/extent.hpp"

namespace perch {

double table_height(const Scene& scene) {
  if (scene.table_height) return *scene.table_height;
  return lowest_height(Observation(scene.camera, scene.depth, scene.mask));
}

CostSettings cost_settings(const Scene& scene, const Settings& settings) {
  CostSettings cost = settings.candidates.cost;
  cost.clutter = scene.clutter;
  if (!cost.charges_points() && std::any_of(scene.objects.begin(), scene.objects.end(),
                                            [](const SceneObject& object) { return object.optional; }))
    throw InputError(
        "objects: one may be absent, but where points of I cost nothing (cost.clutter_points=ignore) leaving "
        "an "
        "object out would always be best; use cost.clutter_points=charge, or list the objects that are "
        "there");
  return cost;
}

std::optional<Guarantee::Clutter> clutter_of(const Scene& scene, const Settings& settings) {
  const CostSettings& cost = settings.candidates.cost;
  if (!scene.clutter) return std::nullopt;
  return Guarantee::Clutter{cost.clutter_weight, name(cost.clutter_points)};
}

std::unique_ptr<LocalizationProblem> make_problem(const Scene& scene, const Settings& settings,
                                                  const Executor& executor, const StopCondition& stop) {
  settings.check();
  CandidateSettings candidate_settings = settings.candidates;
  candidate_settings.cost = cost_settings(scene, settings);
  Observation observation(scene.camera, scene.depth, scene.mask);
  const double table = scene.table_height ? *scene.table_height : lowest_height(observation);
  std::vector<std::optional<ObjectModel>> made(scene.models.size());
  if (!executor.for_each(
          made.size(),
          [&](std::size_t i, std::size_t) {
            const SceneModel& model = scene.models[i];
            made[i].emplace(model.name, model.mesh, model.symmetry, table + model.base,
                            ExplainedBound::field_margin(settings.candidates.cost.delta), executor, stop);
          },
          stop))
    throw Interrupted();
  std::vector<ObjectModel> models;
  models.reserve(2 * made.size());
  for (auto& model : made) models.push_back(std::move(*model));

  // Objects of one model are interchangeable, and all of them optional or none: where a scene has both kinds,
  // the optional ones are objects of a second entry for the same model.
  std::vector<std::size_t> objects;
  std::vector<char> optional(models.size(), 0);
  std::vector<std::size_t> optional_entry(models.size());
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    const auto is = [&](bool wanted) {
      return std::any_of(scene.objects.begin(), scene.objects.end(),
                         [&](const SceneObject& o) { return o.model == m && o.optional == wanted; });
    };
    optional_entry[m] = m;
    if (is(true) && is(false)) {
      optional_entry[m] = models.size();
      models.push_back(ObjectModel(models[m]));
      optional.push_back(1);
    } else if (is(true)) {
      optional[m] = 1;
    }
  }
  for (const SceneObject& object : scene.objects)
    objects.push_back(object.optional ? optional_entry[object.model] : object.model);
  return std::make_unique<LocalizationProblem>(std::move(observation), std::move(models), std::move(objects),
                                               std::move(optional), scene.workspace, candidate_settings,
                                               executor, stop);
}

std::vector<PriorPose> priors_of(const Scene& scene, const LocalizationProblem& problem) {
  std::vector<PriorPose> priors;
  for (const PlacedModel& prior : scene.priors)
    for (std::size_t model = 0; model < problem.models().size(); ++model)
      if (problem.models()[model].name() == scene.models[prior.model].name)
        priors.push_back({model, prior.pose});
  return priors;
}

}  // namespace perch
