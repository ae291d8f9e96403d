#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/baselines/pose_aligner.hpp"
#include "perch/baselines/prepared_scene.hpp"
#include "perch/cost/explanation_cost.hpp"
#include "perch/cost/lone_cost.hpp"
#include "perch/model/collision.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// A pose that a detector proposes for objects of a model.
struct ProposedPose {
  std::size_t model = 0;
  Pose pose;
};

/// The poses that explain the scene best together.
struct JointSelection {
  std::vector<std::optional<Pose>> poses;  ///< of each of Scene::objects
  std::int64_t cost = 0;                   ///< J, the flat explanation cost
  bool complete = true;                    ///< false where the clock struck first
};

/// Chooses a proposed pose for each object so that none collide and J is low: greedily, from several first
/// choices, then by exchanging one pose at a time while J falls, and last by aligning each once more with the
/// others in front of it. Objects of models that nothing is proposed for, or nothing that is free, get none.
/// Given to baselines that propose poses object by object. The same for every executor.
JointSelection select_jointly(const PreparedScene& scene, const ExplanationCost& cost,
                              const CollisionSettings& collision, const PoseAligner& aligner,
                              const std::vector<ProposedPose>& proposed, const Executor& executor,
                              const StopCondition& stop);

}  // namespace perch
