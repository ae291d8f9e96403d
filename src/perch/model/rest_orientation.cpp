#include "perch/model/rest_orientation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perch {

Eigen::Matrix3d rotation_to_up(const Eigen::Vector3d& up) {
  constexpr double least_sine = 1e-9;  // below it the axis is rounding
  const Eigen::Vector3d axis = up.cross(Eigen::Vector3d::UnitZ());
  const double sine = axis.norm();
  if (sine < least_sine)
    return up.z() > 0.0 ? Eigen::Matrix3d::Identity()
                        : Eigen::Matrix3d(Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal());
  return Eigen::AngleAxisd(std::atan2(sine, up.z()), axis / sine).toRotationMatrix();
}

Eigen::Isometry3d stood_from_model(const Mesh& mesh, const Eigen::Vector3d& up) {
  Eigen::Isometry3d stood = Eigen::Isometry3d::Identity();
  stood.linear() = rotation_to_up(up);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& p : mesh.vertices)
    lowest = std::min(lowest, (stood.linear() * p.cast<double>()).z());
  stood.translation().z() = 0.0 - lowest;
  return stood;
}

Mesh transformed(Mesh mesh, const Eigen::Isometry3d& to_from_mesh) {
  if (to_from_mesh.matrix() == Eigen::Matrix4d::Identity()) return mesh;
  for (Eigen::Vector3f& p : mesh.vertices) p = (to_from_mesh * p.cast<double>()).cast<float>();
  return mesh;
}

}  // namespace perch
