#pragma once

#include <Eigen/Geometry>
#include <span>

#include "perch/sim/mesh_builder.hpp"

// What household objects are put together from; metres. For use inside sim.
namespace perch {

/// Sides of what is turned: a chord of a 5 cm radius is then 0.1 mm off its circle.
inline constexpr int turned_sides = 48;
/// Between rings of what is turned, at most.
inline constexpr double up_the_side = 0.012;

/// A handle from wall to wall: where it meets the wall's middle above and below, how far it reaches out, and
/// its elliptic section.
struct HandleShape {
  double top, bottom;  ///< heights of its ends
  double reach;        ///< from the wall
  double half_width = 0.007, half_thickness = 0.0045;
};

Eigen::Isometry3d shift(double x, double y, double z);

/// A vessel's outline: outside up, inside down, with a straight wall.
Profile vessel(double bottom_radius, double rim_radius, double height, double wall, double bottom);

/// A closed tube along a cubic Bezier curve in the plane y = 0 that leaves the wall towards +x and comes back
/// to it level. Radii are those of the wall's middle at its ends.
Mesh handle_mesh(const HandleShape& handle, double wall_radius_top, double wall_radius_bottom);

/// The solid that a profile sweeps, in turned_sides sides.
Mesh turned(std::span<const ProfilePoint> profile, const Section& section = {}, double spacing = up_the_side);

/// A closed cylinder or cone frustum of the given height on z = 0.
Mesh frustum(double bottom_radius, double top_radius, double height);

/// The same thing on its head: turned by half a turn about x, stood on z = 0.
Mesh upside_down(Mesh mesh);

/// The same thing on its side: turned by a quarter about y, so that what was up points along x; stood on z =
/// 0 with the middle of its bounds on the z axis.
Mesh on_its_side(Mesh mesh);

}  // namespace perch
