#include "perch/verify/kd_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace perch {

KdTree::KdTree(std::vector<Eigen::Vector3d> points)
    : points_(std::move(points)), number_(points_.size()), axis_(points_.size()) {
  std::iota(number_.begin(), number_.end(), std::size_t{0});
  build(0, points_.size());
  std::vector<Eigen::Vector3d> ordered;
  ordered.reserve(points_.size());
  for (const std::size_t i : number_) ordered.push_back(points_[i]);
  points_ = std::move(ordered);
}

void KdTree::build(std::size_t begin, std::size_t end) {
  if (begin == end) return;
  Eigen::AlignedBox3d box;
  for (std::size_t i = begin; i < end; ++i) box.extend(points_[number_[i]]);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return number_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [&](std::size_t a, std::size_t b) { return points_[a][axis] < points_[b][axis]; });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

double KdTree::nearest_distance(const Eigen::Vector3d& p) const {
  double squared = std::numeric_limits<double>::infinity();
  nearest(0, points_.size(), p, squared);
  return std::sqrt(squared);
}

void KdTree::nearest(std::size_t begin, std::size_t end, const Eigen::Vector3d& p, double& squared) const {
  if (begin == end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const double offset = p[axis_[middle]] - points_[middle][axis_[middle]];
  if (offset < 0.0)
    nearest(begin, middle, p, squared);
  else
    nearest(middle + 1, end, p, squared);
  if (offset * offset > squared) return;
  squared = std::min(squared, (points_[middle] - p).squaredNorm());
  if (offset < 0.0)
    nearest(middle + 1, end, p, squared);
  else
    nearest(begin, middle, p, squared);
}

}  // namespace perch
