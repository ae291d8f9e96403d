#pragma once

#include <Eigen/Geometry>

#include "perch/core/pose.hpp"

namespace perch {

/// The angle between a pose's z axis and the world's, radians.
double tilt(const Eigen::Isometry3d& world_from_model);

/// The upright pose next to a free one: the turn about z that is nearest to its rotation, and `middle` where
/// it was in x and y. \param middle a point of the model, model frame, metres.
Pose upright_pose(const Eigen::Isometry3d& world_from_model, const Eigen::Vector3d& middle);

}  // namespace perch
