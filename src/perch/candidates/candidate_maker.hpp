#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "perch/candidates/candidate.hpp"
#include "perch/candidates/problem.hpp"
#include "perch/candidates/work.hpp"
#include "perch/cost/lone_cost.hpp"
#include "perch/refine/visible_samples.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {

/// Core seconds spent in the parts of valuing hypotheses.
struct StageSeconds {
  double render = 0.0, refine = 0.0, cost = 0.0;

  StageSeconds& operator+=(const StageSeconds& other) {
    render += other.render;
    refine += other.refine;
    cost += other.cost;
    return *this;
  }
};

/// What a maker did, and how long that took.
struct Effort {
  StageSeconds seconds;
  Work work;
  /// Hypotheses made once more since another process keeps them; not in `work`.
  std::int64_t made_again = 0;

  Effort& operator+=(const Effort& other) {
    seconds += other.seconds;
    work += other.work;
    made_again += other.made_again;
    return *this;
  }
};

/// An object put into a composite: where, and J's counts with it.
struct Placing {
  Pose pose;
  CostCounts counts;
  /// Mean distance of its visible points from I in units of delta, at most 1 each (mean_residual); 0 where
  /// nothing is refined.
  double residual = 0.0;
};

/// Makes candidates: renders, refines, values. Holds scratch memory: one maker a thread.
class CandidateMaker {
 public:
  explicit CandidateMaker(const LocalizationProblem& problem);

  /// The grid pose refined, nothing in front; the grid pose itself, without misfit, where nothing is refined.
  Alignment refined(std::size_t model, const Pose& grid_pose) {
    return problem_.nearest() == nullptr ? Alignment{grid_pose, 0.0} : refine(model, grid_pose, nullptr);
  }
  /// The candidate that grows from a grid pose: refined (if at all) with `in_front`, the parent scene, hiding
  /// part of it; then valued alone. Empty where no pixel of the object is in view.
  std::optional<Candidate> make(std::size_t model, const Pose& grid_pose,
                                const DepthPatch* in_front = nullptr);
  /// Where the last make() looked at its parent scene.
  const Sight& seen() const { return seen_; }
  /// Values an object at a pose as it is; empty where no pixel is in view.
  std::optional<Candidate> value(std::size_t model, const Pose& pose);
  /// J's counts with an object added to a composite at a pose as it is or, where `align`, as ICP makes it
  /// with the composite hiding part of the object; empty where no pixel of it is in view or J is more than
  /// `most`.
  std::optional<Placing> place(const Composite& others, std::size_t model, const Pose& pose, bool align,
                               std::int64_t most);
  /// Fills in `enclosed` and `reached`.
  void add_volumes(Candidate& candidate) const;
  /// The candidate's rendering: the one it keeps, or a new one, which holds until the next call.
  const DepthPatch& patch(const Candidate& candidate);
  /// Renders an object at a pose into `patch`, whose memory is reused.
  void render(std::size_t model, const Pose& pose, DepthPatch& patch);

  /// J with a candidate added to a composite; empty where it is more than `most`.
  std::optional<std::int64_t> cost_with(const Composite& composite, const Candidate& candidate,
                                        std::int64_t most) {
    return cost_with(composite, patch(candidate), most);
  }
  std::optional<std::int64_t> cost_with(const Composite& composite, const DepthPatch& patch,
                                        std::int64_t most = std::numeric_limits<std::int64_t>::max()) {
    const auto counts = lone_cost_.counts_with(composite, patch, most);
    return counts ? std::optional(counts->total()) : std::nullopt;
  }
  /// Adds a candidate, or what is drawn of one, to a composite.
  void add(Composite& composite, const Candidate& candidate) { add(composite, patch(candidate)); }
  void add(Composite& composite, const DepthPatch& patch) { lone_cost_.add(composite, patch); }
  CostChange& scratch() { return change_; }
  const Effort& effort() const { return effort_; }
  /// Starts from nothing, or from what it had done before: what was done since doesn't count.
  void set_effort(const Effort& effort) { effort_ = effort; }
  /// Adds what was done elsewhere in its place.
  void credit(const Effort& effort) { effort_ += effort; }

 private:
  void render(std::size_t model, const Pose& pose) { render(model, pose, patch_); }
  /// Writes what of an object ICP can make use of into samples_.
  void sample(std::size_t model, const Pose& pose, const DepthPatch* in_front);
  Alignment refine(std::size_t model, const Pose& grid_pose, const DepthPatch* in_front);
  Candidate value_rendered(std::size_t model, const Pose& pose);

  const LocalizationProblem& problem_;
  Rasterizer rasterizer_;
  DepthPatch patch_;
  CostChange change_;
  LoneCost lone_cost_;
  LoneValue lone_value_;
  SurfaceSamples samples_;
  Sight seen_;
  Effort effort_;
};

}  // namespace perch
