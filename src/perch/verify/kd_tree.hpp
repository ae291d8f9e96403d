#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

namespace perch {

/// The points of a cloud, ordered so that those near a place are found without looking at all. Distances in
/// double, and exact: every answer is that of brute force.
class KdTree {
 public:
  explicit KdTree(std::vector<Eigen::Vector3d> points);

  std::size_t size() const { return points_.size(); }
  /// From p to the nearest point; infinity where there is none.
  double nearest_distance(const Eigen::Vector3d& p) const;

  /// Calls `visit(i)` with the number of each point within `radius` of p, the near ones about first, until it
  /// returns true. True if it did.
  template <typename Visit>
  bool any_within(const Eigen::Vector3d& p, double radius, Visit visit) const {
    return search(0, points_.size(), p, radius, visit);
  }

 private:
  void build(std::size_t begin, std::size_t end);
  void nearest(std::size_t begin, std::size_t end, const Eigen::Vector3d& p, double& squared) const;

  template <typename Visit>
  bool search(std::size_t begin, std::size_t end, const Eigen::Vector3d& p, double radius,
              Visit& visit) const {
    if (begin == end) return false;
    const std::size_t middle = begin + (end - begin) / 2;
    const double offset = p[axis_[middle]] - points_[middle][axis_[middle]];
    const bool left_first = offset < 0.0;
    if (left_first ? search(begin, middle, p, radius, visit) : search(middle + 1, end, p, radius, visit))
      return true;
    if (offset > radius || offset < -radius) return false;
    if ((points_[middle] - p).norm() <= radius && visit(number_[middle])) return true;
    return left_first ? search(middle + 1, end, p, radius, visit) : search(begin, middle, p, radius, visit);
  }

  // A range's middle point splits it along its axis: no greater coordinates before it, no smaller ones after.
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::size_t> number_;  ///< of each point, as given
  std::vector<std::uint8_t> axis_;
};

}  // namespace perch
