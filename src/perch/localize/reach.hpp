#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>

#include "perch/core/image.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// How far a reading of an object may be off, metres; more is rare.
inline constexpr double reading_noise = 0.02;

/// Where points of a scene's objects can lie, wherever in the workspace they stand: no higher than the
/// highest model's top, no lower than the lowest one's foot and no farther from the workspace than the
/// largest model reaches; all by `margin` more, metres.
class Reach {
 public:
  /// \param table_height where not known, there are no bounds in height. A scene without a workspace has no
  /// bounds to the sides.
  Reach(const Scene& scene, const std::optional<double>& table_height, double margin);
  /// \param p world, metres.
  bool contains(const Eigen::Vector3d& p) const { return box_.contains(p); }
  /// True where the line from `eye` through p comes to what is in reach only behind p; world, metres.
  bool is_behind(const Eigen::Vector3d& eye, const Eigen::Vector3d& p) const;
  /// Narrows it to a rectangle of the world's x and y, metres.
  void limit(const Eigen::AlignedBox2d& place);

 private:
  Eigen::AlignedBox3d box_;
};

/// The readings in reach that are of interest by the scene's mask: non-zero there. \param scene with camera
/// pose.
Image<std::uint8_t> readings_in_reach(const Scene& scene, double table_height, double margin);

}  // namespace perch
