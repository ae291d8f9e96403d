#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "perch/model/symmetry.hpp"

namespace perch {

/// The motions that map a model to itself, in its own frame, metres: what a data set declares of it.
struct ModelSymmetries {
  /// Every turn about the line through `point` along `direction` (unit length).
  struct Axis {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
  };
  std::vector<Eigen::Isometry3d> discrete;  ///< proper; the identity need not be among them
  std::vector<Axis> continuous;

  /// What a Symmetry about z says.
  static ModelSymmetries about_z(const Symmetry& symmetry);

  bool empty() const { return discrete.empty() && continuous.empty(); }
  /// The identity and the motions themselves, those about an axis in `steps` steps of a turn, and each of the
  /// discrete ones followed by these: what BOP takes the least error over.
  std::vector<Eigen::Isometry3d> motions(int steps) const;
  /// True where some of these motions, or one of the discrete ones followed by a turn about an axis, takes
  /// what points along `a` to where `b` points, within `tolerance` (radians): the model then looks the same
  /// whichever of the two points up. \param a, b model frame, unit length.
  bool equal_ups(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double tolerance) const;

  /// A symmetry about a vertical line.
  struct Vertical {
    Symmetry symmetry = Symmetry::none();
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< of the line, model frame
  };
  /// The model's symmetry about a vertical line while `up` points up. An axis within `tolerance` (radians) of
  /// vertical counts as vertical. Turns about several vertical lines can't all be symmetries of a thing of
  /// finite size, so that the first line stands for all.
  Vertical about_up(const Eigen::Vector3d& up, double tolerance) const;
};

}  // namespace perch
