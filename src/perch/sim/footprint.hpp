#pragma once

#include <Eigen/Core>
#include <vector>

#include "perch/core/pose.hpp"
#include "perch/model/mesh.hpp"

namespace perch {

/// The ground that an object takes up: the convex hull of its mesh seen from above, metres. Objects whose
/// footprints lie apart can't touch at any height.
class Footprint {
 public:
  /// In the model's frame.
  explicit Footprint(const Mesh& mesh);

  /// The same footprint where the object stands.
  Footprint at(const Pose& pose) const;
  /// Corners, counter-clockwise; at least one.
  const std::vector<Eigen::Vector2d>& corners() const { return corners_; }

 private:
  std::vector<Eigen::Vector2d> corners_;
};

/// The distance between two footprints, metres; 0 where they overlap.
double gap(const Footprint& a, const Footprint& b);

}  // namespace perch
