#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "perch/candidates/candidate.hpp"
#include "perch/candidates/explained_bound.hpp"
#include "perch/candidates/grid.hpp"
#include "perch/cost/explanation_cost.hpp"
#include "perch/model/collision.hpp"
#include "perch/model/object_model.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/refine/icp.hpp"
#include "perch/refine/surface_views.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {

struct CandidateSettings {
  GridSettings grid;
  CostSettings cost;
  RefineSettings refine;
  CollisionSettings collision;

  void check() const;
  /// Farthest correspondence of ICP, metres.
  double icp_reach() const {
    return refine.reach.value_or(std::min(0.5 * grid.resolution, RefineSettings::largest_reach));
  }
};

/// One localization problem made ready to be searched: what was observed, the models, which are present, and
/// the look-up structures over I. Immutable and shared by all threads.
///
/// A model here is a *body*: a mesh that stands in one way, which is what is rendered, refined, put on a grid
/// and collides. What an object is of is a *kind*: the bodies that it may be, one for each orientation in
/// which a model may rest on the support plane. Copies of a kind are interchangeable, whichever of its bodies
/// they are.
class LocalizationProblem {
 public:
  /// \param objects the kinds present, counting into the kinds; repeats allowed, at least one.
  /// \param optional of each kind: its objects may be absent. Empty: none may.
  /// \param kind_of of each model the number of its kind; kinds are numbered by their first models. Empty:
  /// each is a kind of its own, of the same number. \param workspace derived from I for each model where not
  /// given: the bounds of I widened by the model's radius. Throws InputError where the grid has more poses
  /// than memory allows, InvalidSetting for a bad setting.
  LocalizationProblem(Observation observation, std::vector<ObjectModel> models,
                      std::vector<std::size_t> objects, std::vector<char> optional,
                      const std::optional<Workspace>& workspace, const CandidateSettings& settings,
                      const Executor& executor, const StopCondition& stop = StopCondition(),
                      std::vector<std::size_t> kind_of = {});
  LocalizationProblem(const LocalizationProblem&) = delete;
  LocalizationProblem& operator=(const LocalizationProblem&) = delete;

  const CandidateSettings& settings() const { return settings_; }
  const Observation& observation() const { return observation_; }
  const ExplanationCost& cost() const { return cost_; }
  const PointBlocks& blocks() const { return blocks_; }
  const ExplainedBound& explained_bound() const { return explained_bound_; }
  /// Empty where nothing is refined.
  const NearestTable* nearest() const { return nearest_ ? &*nearest_ : nullptr; }
  const std::vector<ObjectModel>& models() const { return models_; }
  /// What each model shows of its surface, for ICP; only where something is refined.
  const SurfaceViews& views(std::size_t model) const { return views_[model]; }
  /// How many kinds there are.
  std::size_t kinds() const { return bodies_.size(); }
  std::size_t kind_of(std::size_t model) const { return kind_of_[model]; }
  /// The models that an object of a kind may be, ascending; at least one.
  const std::vector<std::size_t>& bodies_of(std::size_t kind) const { return bodies_[kind]; }
  /// What each object is of: kinds.
  const std::vector<std::size_t>& objects() const { return objects_; }
  /// K, the number of objects.
  std::size_t object_count() const { return objects_.size(); }
  /// k_m: how many copies of each kind are present.
  const std::vector<int>& copies() const { return copies_; }
  /// True if objects of this kind may be absent.
  bool optional(std::size_t kind) const { return optional_[kind] != 0; }

  const PoseGrid& grid(std::size_t model) const { return grids_[model]; }
  const Workspace& workspace(std::size_t model) const { return workspaces_[model]; }
  Eigen::Isometry3d camera_from_model(std::size_t model, const Pose& pose) const {
    return camera_from_world_ * models_[model].world_from_model(pose);
  }
  /// True for every pose, but where points of I cost nothing only where the middle of the object's box is in
  /// the image: what is out of view costs nothing there, and would be the best of all.
  bool admits(std::size_t model, const Pose& pose) const;
  /// The same of the model's own frame, in which it is not turned to the orientation that it rests in.
  Eigen::Isometry3d camera_from_unturned(std::size_t model, const Pose& pose) const {
    return camera_from_world_ * models_[model].world_from_unturned(pose);
  }
  /// The pixels that an object can cover; empty where it is out of view.
  Window window(std::size_t model, const Pose& pose) const {
    return explained_bound_.window(models_[model], camera_from_model(model, pose));
  }
  /// Renders a model at a pose: the one way that all counts go through.
  void render(std::size_t model, const Pose& pose, Rasterizer& rasterizer, DepthPatch& patch) const;
  /// Points of I this deep in a model's solid (by its depth_lower_bound) can't be explained by any object
  /// that does not collide with it: its surface within delta of such a point would be too deep. Metres.
  float enclosing_depth(std::size_t model) const { return enclosing_depth_[model]; }
  bool collide(std::size_t model_a, const Pose& pose_a, std::size_t model_b, const Pose& pose_b) const;
  bool collide(const Candidate& a, const Candidate& b) const {
    return !a.absent && !b.absent && collide(a.model, a.pose, b.model, b.pose);
  }

 private:
  CandidateSettings settings_;
  Observation observation_;
  DeltaIndex index_;
  ExplanationCost cost_;
  PointBlocks blocks_;
  ExplainedBound explained_bound_;
  std::optional<NearestTable> nearest_;
  std::vector<ObjectModel> models_;
  std::deque<SurfaceViews> views_;
  std::vector<std::size_t> kind_of_;              ///< of each model
  std::vector<std::vector<std::size_t>> bodies_;  ///< of each kind
  std::vector<std::size_t> objects_;
  std::vector<int> copies_;
  std::vector<char> optional_;
  std::vector<Workspace> workspaces_;
  std::vector<PoseGrid> grids_;
  std::vector<float> enclosing_depth_;
  Eigen::Isometry3d camera_from_world_;
};

}  // namespace perch
