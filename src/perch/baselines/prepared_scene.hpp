#pragma once

#include <vector>

#include "perch/core/stop.hpp"
#include "perch/localize/scene.hpp"
#include "perch/model/collision.hpp"
#include "perch/model/object_model.hpp"
#include "perch/observation/observation.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// What the baselines start from: the same input as the method they are compared with.
struct PreparedScene {
  Observation observation;
  std::vector<ObjectModel> models;     ///< as Scene::models, at their heights above the support plane
  std::vector<Workspace> workspaces;   ///< of each model: where its origin may lie
  std::vector<int> copies;             ///< of each model: how many objects are of it
  std::vector<std::size_t> of_object;  ///< the model of each of Scene::objects

  /// The pose within the model's workspace, its yaw canonical for the model's symmetry.
  Pose admitted(std::size_t model, Pose pose) const;
  /// As collides(), and also where the circles inscribed in two footprints enter each other, at a common
  /// height, by more than the penetration: the rule of PERCH's own code, which needs no solids. Open meshes
  /// have none.
  bool collide(std::size_t a, const Pose& pose_a, std::size_t b, const Pose& pose_b,
               const CollisionSettings& settings) const;
};

/// The support plane's height and the workspaces are the scene's or, where it has none, found as everywhere
/// in perch: from the lowest observed points, and from I widened by a model's radius. Throws InputError where
/// nothing was observed, Interrupted.
PreparedScene prepare(const Scene& scene, const Executor& executor, const StopCondition& stop);

}  // namespace perch
