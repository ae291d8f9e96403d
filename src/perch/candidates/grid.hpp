#pragma once

#include <cstdint>
#include <vector>

#include "perch/core/pose.hpp"
#include "perch/model/symmetry.hpp"

namespace perch {

/// Where object origins may lie, world metres; min < max in both.
struct Workspace {
  double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;
};

/// The steps of the grid of poses.
struct GridSettings {
  double resolution = 0.04;                     ///< step in x and y, metres
  double yaw_resolution = 0.39269908169872414;  ///< step in yaw at most, radians
  std::int64_t max_poses =
      4'000'000;  ///< more grid poses than this are refused: they would not fit into memory

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// The poses of one model: x and y at most `resolution` apart and spread evenly about the workspace's middle;
/// yaws from 0, evenly over the symmetry's period, at most `yaw_resolution` apart; one yaw for a solid of
/// revolution.
class PoseGrid {
 public:
  PoseGrid(const Workspace& workspace, const GridSettings& settings, const Symmetry& symmetry);

  /// Number of poses, as a double so that no size overflows.
  double size() const { return columns_ * rows_ * yaws_; }
  /// \param index 0 .. size() - 1; yaw runs fastest, then x, then y.
  Pose pose(std::int64_t index) const;

 private:
  double columns_, rows_, yaws_;
  double x0_, y0_, step_, yaw_step_;
};

}  // namespace perch
