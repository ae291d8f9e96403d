#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// Something that looks wrong, as file and key name it, and what to do.
struct Warning {
  std::string key;
  std::string what;
  std::string remedy;
};

/// A plane in a depth image, camera frame: points p with normal . p + distance = 0.
struct SeenPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< unit, towards the camera
  double distance = 0.0;                              ///< from the camera, metres, > 0
  double share = 0.0;                                 ///< of the readings, that lie on it
  double rms = 0.0;                                   ///< of these, metres
};

/// The dominant plane of all readings, whatever the scene says of it; empty where there is none.
std::optional<SeenPlane> seen_plane(const Scene& raw);

struct ModelFacts {
  std::string name;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< of the box around it, metres
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< from the box's middle, metres
  std::size_t triangles = 0;
  bool closed = false;
  Symmetry stated = Symmetry::none(), found = Symmetry::none();
  bool found_by_perch = false;  ///< `auto`: the found one is used
  int rest_poses = 1;
  std::int64_t grid_poses = 0;
};

struct DepthFacts {
  double readings = 0.0;                 ///< share of the pixels
  double low = 0, median = 0, high = 0;  ///< hundredths 1, 50 and 99 of the readings, metres
  double observed = 0.0;                 ///< share of the pixels that are points of I
  std::int64_t points = 0;               ///< |I|
  double largest_blob = 0.0;             ///< largest extent of a connected part of I, metres
  double area = 0.0;                     ///< of I seen from the camera, square metres
};

/// What is known of a scene before it is searched.
struct Inspection {
  DepthFacts depth;
  std::optional<SeenPlane> plane;
  std::optional<double> plane_tilt;    ///< against the world's z axis, radians; where there is a camera pose
  std::optional<double> plane_height;  ///< world z below the middle of I, metres
  std::optional<double> table_height;  ///< that is used, metres
  std::vector<ModelFacts> models;
  std::int64_t grid_poses = 0;
  std::optional<double> seconds;  ///< that `perch localize` may take, about
  std::vector<Warning> warnings;
};

/// \param raw as read. \param ready prepared; empty where that failed with the message `fault`.
Inspection inspect(const Scene& raw, const std::optional<Scene>& ready, const std::string& fault,
                   const Settings& settings, const Executor& executor);

}  // namespace perch::app
