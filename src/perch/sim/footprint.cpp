#include "perch/sim/footprint.hpp"

#include <algorithm>
#include <limits>

namespace perch {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// True where a side of `a` has all of `b` beyond it.
bool separates(const std::vector<Eigen::Vector2d>& a, const std::vector<Eigen::Vector2d>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d& from = a[i];
    const Eigen::Vector2d side = a[(i + 1) % a.size()] - from;
    if (std::all_of(b.begin(), b.end(), [&](const auto& p) { return cross(side, p - from) < 0.0; }))
      return true;
  }
  return false;
}

double nearest_corner(const std::vector<Eigen::Vector2d>& sides,
                      const std::vector<Eigen::Vector2d>& corners) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Eigen::Vector2d& from = sides[i];
    const Eigen::Vector2d side = sides[(i + 1) % sides.size()] - from;
    const double length = side.squaredNorm();
    for (const Eigen::Vector2d& p : corners) {
      const double t = length > 0.0 ? std::clamp((p - from).dot(side) / length, 0.0, 1.0) : 0.0;
      least = std::min(least, (p - from - t * side).norm());
    }
  }
  return least;
}

}  // namespace

Footprint::Footprint(const Mesh& mesh) {
  // Andrew's monotone chain.
  std::vector<Eigen::Vector2d> points;
  for (const Eigen::Vector3f& vertex : mesh.vertices) points.push_back(vertex.head<2>().cast<double>());
  const auto before = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  const auto chain = [&](auto first, auto last) {
    const std::size_t start = corners_.size();
    for (auto p = first; p != last; ++p) {
      while (corners_.size() >= start + 2 &&
             cross(corners_.back() - corners_[corners_.size() - 2], *p - corners_.back()) <= 0.0)
        corners_.pop_back();
      corners_.push_back(*p);
    }
    if (points.size() > 1) corners_.pop_back();  // it begins the other chain
  };
  chain(points.begin(), points.end());
  if (points.size() > 1) chain(points.rbegin(), points.rend());
}

Footprint Footprint::at(const Pose& pose) const {
  const Eigen::Isometry3d transform = world_from_model(pose, 0.0);
  Footprint placed = *this;
  for (Eigen::Vector2d& corner : placed.corners_)
    corner = (transform * Eigen::Vector3d(corner.x(), corner.y(), 0.0)).head<2>();
  return placed;
}

double gap(const Footprint& a, const Footprint& b) {
  if (!separates(a.corners(), b.corners()) && !separates(b.corners(), a.corners())) return 0.0;
  return std::min(nearest_corner(a.corners(), b.corners()), nearest_corner(b.corners(), a.corners()));
}

}  // namespace perch
