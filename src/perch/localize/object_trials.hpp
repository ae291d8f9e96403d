#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/candidates/candidate_maker.hpp"
#include "perch/candidates/problem.hpp"
#include "perch/core/stop.hpp"
#include "perch/localize/scene.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// All the objects of a scene, and its flat J.
struct ArrangedScene {
  std::vector<PlacedModel> placed;
  std::int64_t cost = 0;
};

/// A pose to be tried: as it is, or after ICP with the other objects in front.
struct Trial {
  Pose pose;
  bool align = false;
  std::optional<std::size_t> model = std::nullopt;  ///< another body of the object's kind; else its own
};

/// The pose that was tried, and what the scene is worth with the object there.
struct TrialResult {
  Pose pose;
  std::int64_t cost = 0;  ///< J
  double residual = 0.0;  ///< as Placing::residual
  std::size_t model = 0;  ///< the body
};

/// The rendering of each object of a scene, drawn again only where the object has moved.
class SceneDrawings {
 public:
  /// Keeps references. \param makers one for each worker of the executor.
  SceneDrawings(std::vector<CandidateMaker>& makers, const Executor& executor)
      : makers_(makers), executor_(executor) {}

  /// False where the stop condition struck first: then not all is drawn.
  bool draw(const std::vector<PlacedModel>& scene, const StopCondition& stop);
  /// Of the object at a place of the scene drawn last.
  const DepthPatch& operator[](std::size_t place) const { return patches_[place]; }

 private:
  std::vector<CandidateMaker>& makers_;
  const Executor& executor_;
  std::vector<PlacedModel> drawn_;
  std::vector<DepthPatch> patches_;  ///< of drawn_
};

/// Tries poses of one object of a scene while all the others stay where they are. Every cost is exact, and
/// the same for every executor.
class ObjectTrials {
 public:
  /// Keeps references. \param makers one for each worker of the executor. \param worker the one that calls,
  /// where that is one of them.
  ObjectTrials(const LocalizationProblem& problem, std::vector<CandidateMaker>& makers,
               const Executor& executor, const StopCondition& stop, std::size_t worker = 0);

  /// Takes the object at `place` out of a scene; the trials that follow put it back. \param drawings of this
  /// scene.
  void take_out(const std::vector<PlacedModel>& scene, std::size_t place, const SceneDrawings& drawings);
  const ObjectModel& model() const { return model(model_); }
  const ObjectModel& model(std::size_t number) const { return problem_.models()[number]; }
  std::size_t model_number() const { return model_; }
  /// The other objects.
  const Composite& others() const { return others_; }
  /// J of the other objects alone.
  std::int64_t cost_without() const { return problem_.cost().counts(others_).total(); }
  /// True where the object would lie in its workspace and touch none of the others.
  bool fits(const Pose& pose) const { return fits(model_, pose); }

  /// How many points of a drawing are in view beside the others.
  std::int64_t visible_points(const DepthPatch& patch) const;
  /// How many of these lie within delta of I.
  std::int64_t explained_points(const DepthPatch& patch) const;

  /// One answer for each trial, in order; empty where the object doesn't fit, no pixel of it is in view, or J
  /// is more than `most`, which takes less work to find out. Yaws are canonical. False where the stop
  /// condition struck first: then the answers are not complete.
  bool run(const std::vector<Trial>& trials, std::int64_t most,
           std::vector<std::optional<TrialResult>>& answers);
  /// A single trial of a pose as it is, on the calling thread.
  std::optional<TrialResult> run_one(const Pose& pose);
  bool stopped() const { return stop_(); }
  /// How many trials were run.
  std::int64_t count() const { return count_; }

 private:
  template <typename Wanted>
  std::int64_t count_visible(const DepthPatch& patch, const Wanted& wanted) const;
  bool fits(std::size_t model, const Pose& pose) const;
  std::optional<TrialResult> run(const Trial& trial, std::int64_t most, CandidateMaker& maker) const;

  const LocalizationProblem& problem_;
  std::vector<CandidateMaker>& makers_;
  const Executor& executor_;
  const StopCondition& stop_;
  CandidateMaker& own_;  ///< of the worker that calls
  std::size_t model_ = 0;
  std::vector<PlacedModel> standing_;  ///< the other objects
  Composite others_;
  std::int64_t count_ = 0;
};

}  // namespace perch
