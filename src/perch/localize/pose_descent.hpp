#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "perch/localize/finish_settings.hpp"
#include "perch/localize/object_trials.hpp"

namespace perch {

/// Which of two poses of an object is the better one. J alone is flat where every point lies within delta,
/// and its lowest point there is noise. So a step must not raise J, and must lower J + residual_weight * (J
/// without the object - J at the start) * (mean residual).
class TrialOrder {
 public:
  TrialOrder() = default;
  TrialOrder(const ObjectTrials& trials, const TrialResult& start, const DescentSettings& settings);

  double value(const TrialResult& result) const {
    return static_cast<double>(result.cost) + weight_ * result.residual;
  }
  bool improves(const TrialResult& result, const TrialResult& on) const {
    return result.cost <= on.cost && value(result) < value(on);
  }

 private:
  double weight_ = 0.0;
};

/// Moves one object of a scene downhill, as the body that it is, while the others stay: ICP with the others
/// in front, then a pattern search in x, y and yaw. Every step improves on the one before by TrialOrder.
class PoseDescent {
 public:
  /// Where an object may go; empty: anywhere that it fits.
  using Region = std::function<bool(const Pose&)>;

  /// Keeps references. \param trials the object is taken out of the scene. \param budget trials it may run.
  PoseDescent(ObjectTrials& trials, const DescentSettings& settings, std::int64_t budget)
      : trials_(trials), settings_(settings), left_(budget) {}

  /// Where the object gets to from `start`, a result of the same trials; `start` itself where nothing better
  /// was met. \param turn tries other yaws too.
  TrialResult run(const TrialResult& start, bool turn, const Region& region = {});
  /// False once the budget is spent or the stop condition has struck: what run returns is the best so far.
  bool going() const { return going_; }
  std::int64_t left() const { return left_; }

 private:
  void realign(bool turn);
  void search_pattern();
  void extend(const TrialResult& before);
  bool run_batch();

  ObjectTrials& trials_;
  const DescentSettings& settings_;
  std::int64_t left_;
  bool going_ = true;
  const Region* region_ = nullptr;
  TrialOrder order_;
  TrialResult at_;
  /// Adds a pose of the body that is being moved to the batch.
  void add(const Pose& pose, bool align) { batch_.push_back({pose, align, at_.model}); }

  std::vector<Trial> batch_;
  std::size_t taken_ = 0;  ///< of the batch, where it lowered the value
  std::vector<std::optional<TrialResult>> answers_;
};

}  // namespace perch
