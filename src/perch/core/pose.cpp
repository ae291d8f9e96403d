#include "perch/core/pose.hpp"

#include <Eigen/SVD>
#include <cmath>
#include <numbers>
#include <string>

#include "perch/core/error.hpp"

namespace perch {

Eigen::Isometry3d world_from_model(const Pose& pose, double z) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  transform.linear() << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  transform.translation() << pose.x, pose.y, z;
  return transform;
}

double wrap_angle(double radians) {
  const double wrapped = std::remainder(radians, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

double angle_difference(double a, double b, double period) {
  return std::abs(std::remainder(a - b, period));
}

Eigen::Isometry3d rigid_transform(const Eigen::Matrix4d& matrix, const char* what) {
  constexpr double tolerance = 1e-3;  // matrices are often written with few digits
  const auto fail = [&](const char* why) { throw InputError(std::string(what) + why); };
  if (!matrix.allFinite()) fail(" holds a value that is not finite");
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > tolerance)
    fail(" is not a rigid transform: its last row must be 0 0 0 1");
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  if ((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() > tolerance)
    fail(
        " is not a rigid transform: its rotation part is not orthonormal (scaled, sheared or rounded too "
        "much)");
  if (rotation.determinant() < 0)
    fail(" is not a rigid transform: its rotation part is a reflection (det = -1)");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.linear() = svd.matrixU() * svd.matrixV().transpose();
  transform.translation() = matrix.topRightCorner<3, 1>();
  return transform;
}

}  // namespace perch
