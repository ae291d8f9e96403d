#include "perch/localize/pose_descent.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace perch {

TrialOrder::TrialOrder(const ObjectTrials& trials, const TrialResult& start, const DescentSettings& settings)
    : weight_(settings.residual_weight *
              static_cast<double>(std::max<std::int64_t>(0, trials.cost_without() - start.cost))) {}

TrialResult PoseDescent::run(const TrialResult& start, bool turn, const Region& region) {
  region_ = &region;
  at_ = start;
  order_ = TrialOrder(trials_, start, settings_);
  realign(turn);
  search_pattern();
  return at_;
}

void PoseDescent::realign(bool turn) {
  const Symmetry& symmetry = trials_.model(at_.model).symmetry();
  batch_.clear();
  add(at_.pose, true);
  if (turn && !symmetry.is_continuous())
    for (int k = 1; k <= settings_.turns; ++k) {
      const double yaw = at_.pose.yaw + symmetry.period() * k / (settings_.turns + 1);
      add({at_.pose.x, at_.pose.y, yaw}, true);
    }
  run_batch();
}

void PoseDescent::search_pattern() {
  const ObjectModel& model = trials_.model(at_.model);
  const double arm = std::max(model.radius(), settings_.largest_step);
  const bool turns = !model.symmetry().is_continuous();
  // Two step lengths at a time keep more workers busy, and cost no more than one after the other where none
  // helps.
  for (double step = settings_.largest_step; step >= settings_.smallest_step && going_;) {
    const TrialResult before = at_;
    const Pose& from = before.pose;
    batch_.clear();
    for (double length = step; length >= std::max(0.5 * step, settings_.smallest_step); length *= 0.5)
      for (const double way : {length, -length}) {
        add({from.x + way, from.y, from.yaw}, false);
        add({from.x, from.y + way, from.yaw}, false);
        if (turns) add({from.x, from.y, from.yaw + way / arm}, false);
      }
    if (run_batch())
      extend(before);
    else
      step *= 0.25;
  }
}

/// Goes on the way that helped: twice as far, and by the best of every axis at once.
void PoseDescent::extend(const TrialResult& before) {
  const Pose& from = before.pose;
  const Pose best = batch_[taken_].pose;
  Pose together = from;
  std::array<double, 3> least;  // along x, y and yaw
  least.fill(order_.value(before));
  for (std::size_t i = 0; i < batch_.size(); ++i) {
    if (!answers_[i] || answers_[i]->cost > before.cost) continue;
    const Pose& pose = batch_[i].pose;
    const std::size_t axis = pose.x != from.x ? 0 : pose.y != from.y ? 1 : 2;
    if (order_.value(*answers_[i]) >= least[axis]) continue;
    least[axis] = order_.value(*answers_[i]);
    if (axis == 0) together.x = pose.x;
    if (axis == 1) together.y = pose.y;
    if (axis == 2) together.yaw = pose.yaw;
  }
  batch_.clear();
  add({2.0 * best.x - from.x, 2.0 * best.y - from.y, 2.0 * best.yaw - from.yaw}, false);
  if (!(together == best)) add(together, false);
  run_batch();
}

bool PoseDescent::run_batch() {
  if (!going_) return false;
  left_ -= static_cast<std::int64_t>(batch_.size());
  if (left_ < 0 || !trials_.run(batch_, at_.cost, answers_)) {
    going_ = false;
    return false;
  }
  bool fell = false;
  for (std::size_t i = 0; i < answers_.size(); ++i) {
    if (answers_[i] && *region_ && !(*region_)(answers_[i]->pose)) answers_[i].reset();
    if (!answers_[i] || !order_.improves(*answers_[i], at_)) continue;
    at_ = *answers_[i];
    taken_ = i;
    fell = true;
  }
  return fell;
}

}  // namespace perch
