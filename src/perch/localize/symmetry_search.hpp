#pragma once

#include <Eigen/Core>
#include <optional>

#include "perch/model/mesh.hpp"
#include "perch/model/symmetry.hpp"

namespace perch {

/// The symmetry of a mesh as a depth camera sees it.
struct FoundSymmetry {
  struct Axis {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< x and y of the axis in the mesh's frame, metres
    Symmetry symmetry = Symmetry::none();
  };
  Symmetry symmetry = Symmetry::none();  ///< about the mesh's own z axis
  /// An upright axis elsewhere about which the mesh has more symmetry than about its own; one that runs
  /// through the middle of what is seen of it.
  std::optional<Axis> better_axis;
};

/// Finds the finest symmetry about z, geometry only, that a camera of resolution `delta` (metres) can't tell
/// from an exact one: continuous, or n-fold with n <= 36. Points of the surface that are seen from around and
/// above, turned by each angle of the symmetry, must lie within delta / 2 of the surface, all but 1 % of
/// them, and all within delta. So what a rendering in one yaw shows is explained, in the sense of the cost J,
/// by one in the other, with half of delta left to the sensor's noise; and no part that reaches delta beyond
/// the rest, such as a handle, goes unnoticed, however small its share. What is smaller than 1 % of the
/// mesh's size may. Takes about 0.1 s on one core; the same on every machine.
FoundSymmetry find_symmetry(const Mesh& mesh, double delta);

}  // namespace perch
