#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <span>
#include <vector>

#include "perch/model/mesh.hpp"

namespace perch {

/// A corner of the outline that a solid of revolution is turned from, metres.
struct ProfilePoint {
  double radius;  ///< distance from the z axis, >= 0
  double z;
};
using Profile = std::vector<ProfilePoint>;

/// What the radius of a profile is multiplied with at an angle about z (radians, 0 along x) and a height z
/// (metres): 1 everywhere makes a solid of revolution.
using Section = std::function<double(double angle, double z)>;

/// A closed surface through rings of points, metres. All rings have the same number of points (at least 3),
/// counter-clockwise seen against the direction in which the rings advance; the first and the last are single
/// points. Flat where they should be, two triangles between neighbours elsewhere, none without area.
Mesh loft(const std::vector<std::vector<Eigen::Vector3d>>& rings);

/// The solid that a profile sweeps about z, with `segments` flat sides. The profile begins and ends on the
/// axis (radius 0), touches it nowhere else, and runs with the solid to its left in the (radius, z) plane:
/// along the bottom, up the outside, and for a vessel down its inside.
Mesh revolve(std::span<const ProfilePoint> profile, int segments, const Section& section = {});

/// The section of a regular prism with n sides, whose corners lie on the circle; corners at multiples of 2 pi
/// / n.
Section polygon_section(int n);

/// The profile with its inner corners rounded: a curve of `steps` chords leaves each corner's sides `reach`
/// metres from the corner, or half way along the side where it is shorter than twice that.
Profile rounded(std::span<const ProfilePoint> profile, double reach, int steps = 4);

/// The same outline with further points on it, so that none are farther apart than `spacing` metres. Sides
/// that end on the axis stay whole.
Profile subdivided(std::span<const ProfilePoint> profile, double spacing);

/// A box of the given size, metres, centred on the z axis and standing on z = 0, its faces cut into cells of
/// at most `cell` metres.
Mesh box(const Eigen::Vector3d& size, double cell);

/// A tube with an elliptic section and flat ends along a path in the plane y = 0, metres. `half_width` is
/// measured along y, `half_thickness` across the path within the plane.
Mesh tube(std::span<const Eigen::Vector2d> path_xz, double half_width, double half_thickness, int segments);

/// The same shape at another place.
Mesh moved(Mesh mesh, const Eigen::Isometry3d& transform);
/// The same shape scaled along the axes; factors > 0.
Mesh scaled(Mesh mesh, const Eigen::Vector3d& factors);
/// All the triangles in one mesh. Closed components stay closed, also where they run into each other.
Mesh merged(const std::vector<Mesh>& parts);

/// The volume that a closed mesh bounds, cubic metres, positive where its triangles face outwards. Where
/// components overlap, what they share counts once for each.
double signed_volume(const Mesh& mesh);

}  // namespace perch
