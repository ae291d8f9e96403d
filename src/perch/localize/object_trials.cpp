#include "perch/localize/object_trials.hpp"

#include <algorithm>
#include <limits>

namespace perch {

ObjectTrials::ObjectTrials(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
                           const Executor& executor, const StopCondition& stop)
    : problem_(problem), makers_(makers), executor_(executor), stop_(stop) {}

void ObjectTrials::take_out(const std::vector<PlacedModel>& scene, std::size_t place) {
  model_ = scene[place].model;
  standing_.clear();
  others_ = problem_.cost().empty();
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (i == place) continue;
    standing_.push_back(scene[i]);
    makers_.front().add(others_, drawing(scene, i));
  }
}

const DepthPatch& ObjectTrials::drawing(const std::vector<PlacedModel>& scene, std::size_t place) {
  if (drawn_.size() < scene.size()) {
    drawn_.resize(scene.size());
    drawings_.resize(scene.size());
  }
  const PlacedModel& object = scene[place];
  PlacedModel& drawn = drawn_[place];
  if (drawings_[place].window.empty() || drawn.model != object.model || !(drawn.pose == object.pose)) {
    makers_.front().render(object.model, object.pose, drawings_[place]);
    drawn = object;
  }
  return drawings_[place];
}

std::int64_t ObjectTrials::visible_points(const std::vector<PlacedModel>& scene, std::size_t place) {
  const DepthPatch& patch = drawing(scene, place);
  std::int64_t points = 0;
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u)
      points += patch.at(u, v) < others_.depth.at_or_none(u, v) && problem_.cost().counts_at(u, v);
  return points;
}

bool ObjectTrials::fits(const Pose& pose) const {
  const Workspace& workspace = problem_.workspace(model_);
  return pose.x >= workspace.x_min && pose.x <= workspace.x_max && pose.y >= workspace.y_min &&
         pose.y <= workspace.y_max &&
         std::none_of(standing_.begin(), standing_.end(), [&](const PlacedModel& other) {
           return problem_.collide(model_, pose, other.model, other.pose);
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
  return run({pose, false}, std::numeric_limits<std::int64_t>::max(), makers_.front());
}

std::optional<TrialResult> ObjectTrials::run(const Trial& trial, std::int64_t most,
                                             CandidateMaker& maker) const {
  Pose pose = trial.pose;
  pose.yaw = model().symmetry().canonical_yaw(pose.yaw);
  if (!trial.align && !fits(pose)) return std::nullopt;
  const auto placing = maker.place(others_, model_, pose, trial.align, most);
  if (!placing || (trial.align && !fits(placing->pose))) return std::nullopt;
  return TrialResult{placing->pose, placing->counts.total(), placing->residual};
}

}  // namespace perch
