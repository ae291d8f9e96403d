#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

namespace perch {

/// The points of a file, in its own unit and frame.
struct PointCloud {
  /// How the points lie on the pixels of a camera, row by row.
  struct Grid {
    std::uint64_t width = 0, height = 0;
  };

  std::vector<Eigen::Vector3d> points;  ///< not finite, or all zero, where there is no reading
  std::optional<Grid> grid;             ///< where the file says that the cloud is organized
  /// Where the sensor stood, in the frame of the points; the identity where the file doesn't say.
  Eigen::Isometry3d file_from_sensor = Eigen::Isometry3d::Identity();
};

}  // namespace perch
