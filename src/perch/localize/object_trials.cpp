#include "perch/localize/object_trials.hpp"

#include <algorithm>
#include <limits>

namespace perch {

bool SceneDrawings::draw(const std::vector<PlacedModel>& scene, const StopCondition& stop) {
  drawn_.resize(scene.size());
  patches_.resize(scene.size());
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < scene.size(); ++i)
    if (patches_[i].window.empty() || drawn_[i].model != scene[i].model || !(drawn_[i].pose == scene[i].pose))
      moved.push_back(i);
  const bool complete = executor_.for_each(
      moved.size(),
      [&](std::size_t i, std::size_t worker) {
        const PlacedModel& object = scene[moved[i]];
        makers_[worker].render(object.model, object.pose, patches_[moved[i]]);
        drawn_[moved[i]] = object;
      },
      stop);
  return complete;
}

ObjectTrials::ObjectTrials(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                           const Executor& executor, const StopCondition& stop, std::size_t worker)
    : problem_(problem), makers_(makers), executor_(executor), stop_(stop), own_(makers[worker]) {}

void ObjectTrials::take_out(const std::vector<PlacedModel>& scene, std::size_t place,
                            const SceneDrawings& drawings) {
  model_ = scene[place].model;
  standing_.clear();
  others_ = problem_.cost().empty();
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (i == place) continue;
    standing_.push_back(scene[i]);
    own_.add(others_, drawings[i]);
  }
}

template <typename Wanted>
std::int64_t ObjectTrials::count_visible(const DepthPatch& patch, const Wanted& wanted) const {
  std::int64_t points = 0;
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u) {
      const float z = patch.at(u, v);
      points += z < others_.depth.at_or_none(u, v) && problem_.cost().counts_at(u, v, z) && wanted(u, v, z);
    }
  return points;
}

std::int64_t ObjectTrials::visible_points(const DepthPatch& patch) const {
  return count_visible(patch, [](int, int, float) { return true; });
}

std::int64_t ObjectTrials::explained_points(const DepthPatch& patch) const {
  return count_visible(patch,
                       [&](int u, int v, float z) { return problem_.cost().index().explained(u, v, z); });
}

bool ObjectTrials::fits(std::size_t model, const Pose& pose) const {
  const Workspace& workspace = problem_.workspace(model);
  return pose.x >= workspace.x_min && pose.x <= workspace.x_max && pose.y >= workspace.y_min &&
         pose.y <= workspace.y_max &&
         std::none_of(standing_.begin(), standing_.end(), [&](const PlacedModel& other) {
           return problem_.collide(model, pose, other.model, other.pose);
         });
}

bool ObjectTrials::run(const std::vector<Trial>& trials, std::int64_t most,
                       std::vector<std::optional<TrialResult>>& answers) {
  answers.assign(trials.size(), std::nullopt);
  count_ += static_cast<std::int64_t>(trials.size());
  return executor_.for_each(
      trials.size(),
      [&](std::size_t i, std::size_t worker) { answers[i] = run(trials[i], most, makers_[worker]); }, stop_);
}

std::optional<TrialResult> ObjectTrials::run_one(const Pose& pose) {
  ++count_;
  return run({pose}, std::numeric_limits<std::int64_t>::max(), own_);
}

std::optional<TrialResult> ObjectTrials::run(const Trial& trial, std::int64_t most,
                                             CandidateMaker& maker) const {
  const std::size_t body = trial.model.value_or(model_);
  Pose pose = trial.pose;
  pose.yaw = model(body).symmetry().canonical_yaw(pose.yaw);
  if (!trial.align && !fits(body, pose)) return std::nullopt;
  const auto placing = maker.place(others_, body, pose, trial.align, most);
  if (!placing || (trial.align && !fits(body, placing->pose))) return std::nullopt;
  return TrialResult{placing->pose, placing->counts.total(), placing->residual, body};
}

}  // namespace perch
