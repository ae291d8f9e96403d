#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"

namespace perch {

/// A plane that objects stand on, camera frame: points p with normal . p + distance = 0.
struct SupportPlane {
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitY();  ///< unit, up: towards the camera
  double distance = 0.0;                               ///< from the camera, metres, > 0
  std::int64_t readings = 0;                           ///< that lie on it
  double share = 0.0;                                  ///< of all readings
  double rms = 0.0;                                    ///< distance of these from it, metres
  double area = 0.0;  ///< of its largest connected part that is seen, square metres

  /// How far a point lies above it, metres.
  double above(const Eigen::Vector3d& p) const { return normal.dot(p) + distance; }
};

/// How far from a plane its readings lie at a depth, metres: a few millimetres, and what triangulation adds
/// with the square of the depth; about three standard deviations of the first Kinect (Khoshelham and
/// Elberink, Sensors 12, 2012: 1.5 mm at 1 m), and the unevenness of real tables.
double plane_tolerance(double depth);

struct PlaneSearch {
  std::uint64_t seed = 1;
  /// Which way is up, camera frame, unit, and by how much at most the plane may be tilted against it,
  /// radians. Without it any plane seen from above will do: one whose normal points up in the
  /// image or, where there is none, towards the camera.
  std::optional<Eigen::Vector3d> up;
  double most_tilt = 0.14;
  /// Smaller planes are the tops of objects, square metres.
  double least_area = 0.03;
};

/// The plane that carries what is seen: of the planes seen from above the one with most readings, or a higher
/// one on which something stands, where that is large and, as a table over the floor, well above. Found by
/// RANSAC (Fischler and Bolles, 1981) over a thinned depth image, one plane after the other, and fitted to
/// all readings near it by least squares with Tukey's weights. Deterministic. Empty where there is none.
std::optional<SupportPlane> find_support_plane(const DepthImage& depth, const Intrinsics& intrinsics,
                                               const PlaneSearch& search);

}  // namespace perch
