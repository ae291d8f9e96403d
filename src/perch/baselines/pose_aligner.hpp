#pragma once

#include <deque>

#include "perch/baselines/prepared_scene.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/refine/icp.hpp"
#include "perch/refine/surface_views.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// ICP in (x, y, yaw) of what can be seen of an object: the alignment of the method that the baselines are
/// compared with, given to them too. Safe for several threads.
class PoseAligner {
 public:
  /// Keeps references. Throws Interrupted.
  PoseAligner(const PreparedScene& scene, const RefineSettings& settings, const Executor& executor,
              const StopCondition& stop);

  /// The pose after the settings' rounds. \param in_front rendered surfaces that hide the object, or nullptr.
  Pose align(std::size_t model, const Pose& start, const DepthPatch* in_front) const;

 private:
  const PreparedScene& scene_;
  const RefineSettings& settings_;
  double reach_;
  NearestTable observed_;
  std::deque<SurfaceViews> views_;
};

}  // namespace perch
