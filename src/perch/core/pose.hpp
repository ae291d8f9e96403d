#pragma once

#include <Eigen/Geometry>

namespace perch {

/// Where an object stands on the support plane: world coordinates of the model's origin in metres, yaw about
/// world z in radians. Together with the model's height above the world origin it makes `world_from_model`.
struct Pose {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;

  friend bool operator==(const Pose&, const Pose&) = default;
};

/// The rigid transform that a pose stands for. \param z height of the model's origin in the world, metres.
Eigen::Isometry3d world_from_model(const Pose& pose, double z);

/// The same angle in (-pi, pi].
double wrap_angle(double radians);

/// Smallest absolute difference of two angles that are equal modulo `period` (radians, > 0).
double angle_difference(double a, double b, double period);

/// The rigid transform in a 4 x 4 matrix, or a thrown InputError that says what is wrong with it: not finite,
/// last row not 0 0 0 1, rotation not orthonormal to 1e-3, or a reflection. The rotation returned is
/// orthonormal to rounding.
Eigen::Isometry3d rigid_transform(const Eigen::Matrix4d& matrix, const char* what);

}  // namespace perch
