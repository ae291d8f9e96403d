#include "perch/baselines/upright_pose.hpp"

#include <algorithm>
#include <cmath>

namespace perch {

double tilt(const Eigen::Isometry3d& world_from_model) {
  return std::acos(std::clamp(world_from_model.linear()(2, 2), -1.0, 1.0));
}

Pose upright_pose(const Eigen::Isometry3d& world_from_model, const Eigen::Vector3d& middle) {
  const auto& rotation = world_from_model.linear();
  // Maximizes the trace of turn^T rotation.
  const double yaw = std::atan2(rotation(1, 0) - rotation(0, 1), rotation(0, 0) + rotation(1, 1));
  const Eigen::Vector3d there = world_from_model * middle;
  const Eigen::Vector3d turned = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * middle;
  return {there.x() - turned.x(), there.y() - turned.y(), yaw};
}

}  // namespace perch
