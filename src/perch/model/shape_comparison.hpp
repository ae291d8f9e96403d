#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "perch/model/mesh.hpp"

namespace perch {

/// Tells whether a shape looks the same after a motion: whether it maps (nearly) all of the surface to within
/// a tolerance of the surface.
class ShapeComparison {
 public:
  /// \param tolerance metres. \param centre what vertical axes run through: the shape's centre of mass.
  ShapeComparison(const Mesh& mesh, const Eigen::Vector3d& centre, double tolerance);
  ~ShapeComparison();
  ShapeComparison(const ShapeComparison&) = delete;
  ShapeComparison& operator=(const ShapeComparison&) = delete;

  /// True where the shape standing with `a` up looks like the shape standing with `b` up, but for a turn and
  /// a shift on the plane: 95 of 100 points spread over the surface of the one lie within the tolerance of
  /// the other, and no point farther than three times that. Distances are known to a third of the tolerance,
  /// of things of more than 0.05 square metres to 0.4 % of the square root of their surface, and what may be
  /// within the tolerance is taken as within. \param a, b model frame, unit length.
  bool equal_ups(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

 private:
  struct Tree;
  /// How far a motion takes the surface from itself.
  struct Gap {
    bool within = false;
    double mean = std::numeric_limits<double>::infinity();  ///< metres; only where `within`
  };
  Gap gap(const Eigen::Matrix3d& turn, double lift, double slack_per_radius, const Eigen::Vector3d& up) const;
  /// The axis through the centre about which the shape looks the same however it is turned.
  std::optional<Eigen::Vector3d> axis_of_revolution(const Mesh& mesh) const;
  double lowest(const Eigen::Vector3d& up) const;

  std::unique_ptr<Tree> tree_;
  std::vector<Eigen::Vector3d> probes_;   ///< of the surface, about the centre
  std::vector<Eigen::Vector3d> corners_;  ///< the vertices, about the centre
  std::optional<Eigen::Vector3d> axis_;
  double tolerance_, radius_ = 0.0;
};

}  // namespace perch
