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
            const RestPose rest{model.rest_pose, rest_pose_count(scene.models, i) == 1,
                                model.stood_from_model};
            made[i].emplace(model.name, model.mesh, model.symmetry, table + model.base,
                            ExplainedBound::field_margin(settings.candidates.cost.delta), executor, stop,
                            rest);
          },
          stop))
    throw Interrupted();
  std::vector<ObjectModel> models;
  std::vector<std::size_t> kinds;  // of the models
  models.reserve(2 * made.size());
  std::size_t next_kind = 0;
  std::vector<std::size_t> kind_of_first(made.size());  // by the first body of a scene's model
  for (std::size_t m = 0; m < made.size(); ++m) {
    if (scene.kind(m) == m) kind_of_first[m] = next_kind++;
    kinds.push_back(kind_of_first[scene.kind(m)]);
    models.push_back(std::move(*made[m]));
  }

  // Objects of one kind are interchangeable, and all of them optional or none: where a scene has both of a
  // model, the optional ones are of a second kind with bodies of its own.
  std::vector<std::size_t> objects;
  std::vector<char> optional(next_kind, 0);
  std::vector<std::size_t> optional_kind = kind_of_first;
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    if (scene.kind(m) != m) continue;
    const auto is = [&](bool wanted) {
      return std::any_of(scene.objects.begin(), scene.objects.end(),
                         [&](const SceneObject& o) { return o.model == m && o.optional == wanted; });
    };
    if (is(true) && is(false)) {
      optional_kind[m] = next_kind++;
      optional.push_back(1);
      for (std::size_t body = m; body < m + rest_pose_count(scene.models, m); ++body) {
        models.push_back(ObjectModel(models[body]));
        kinds.push_back(optional_kind[m]);
      }
    } else if (is(true)) {
      optional[kind_of_first[m]] = 1;
    }
  }
  for (const SceneObject& object : scene.objects)
    objects.push_back(object.optional ? optional_kind[object.model] : kind_of_first[object.model]);
  return std::make_unique<LocalizationProblem>(std::move(observation), std::move(models), std::move(objects),
                                               std::move(optional), scene.workspace, candidate_settings,
                                               executor, stop, std::move(kinds));
}

std::vector<PriorPose> priors_of(const Scene& scene, const LocalizationProblem& problem) {
  std::vector<PriorPose> priors;
  for (const PlacedModel& prior : scene.priors)
    for (std::size_t model = 0; model < problem.models().size(); ++model)
      if (problem.models()[model].name() == scene.models[prior.model].name &&
          problem.models()[model].rest().index == scene.models[prior.model].rest_pose)
        priors.push_back({model, prior.pose});
  return priors;
}

}  // namespace perch
