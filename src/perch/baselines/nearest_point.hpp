#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace perch {

/// The nearest of a cloud's points to any given point, exactly, however far: a k-d tree.
class NearestPoint {
 public:
  /// \param cloud at least one point.
  explicit NearestPoint(std::vector<Eigen::Vector3f> cloud);
  ~NearestPoint();

  /// Squared distance to it; of the cloud's unit, squared.
  float squared_distance(const Eigen::Vector3f& from) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

}  // namespace perch
