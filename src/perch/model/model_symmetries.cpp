#include "perch/model/model_symmetries.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace perch {
namespace {

constexpr int largest_fold = 360;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The n of the group that turns by `angle` make: the least n of which n times the angle is a whole number of
/// turns; 1 where there is none up to 360.
int fold_of(double angle) {
  constexpr double near = 1e-2;  // radians, after n turns: files hold rounded matrices
  for (int n = 1; n <= largest_fold; ++n) {
    const double turns = std::abs(angle) * n / (2.0 * std::numbers::pi);
    if (std::round(turns) >= 1.0 && std::abs(turns - std::round(turns)) * 2.0 * std::numbers::pi < near)
      return n;
  }
  return 1;
}

/// A point that a turn about a line leaves in its place. \param direction of the line, unit length.
Eigen::Vector3d fixed_point(const Eigen::Isometry3d& turn, const Eigen::Vector3d& direction) {
  // (I - R) p = t; along the line I - R is 0, where the projection makes it regular.
  const Eigen::Matrix3d regular =
      Eigen::Matrix3d::Identity() - turn.linear() + direction * direction.transpose();
  return regular.partialPivLu().solve(turn.translation() - direction * direction.dot(turn.translation()));
}

}  // namespace

ModelSymmetries ModelSymmetries::about_z(const Symmetry& symmetry) {
  ModelSymmetries all;
  if (symmetry.is_continuous()) all.continuous.emplace_back();
  for (int i = 1; i < symmetry.fold(); ++i)
    all.discrete.emplace_back(Eigen::AngleAxisd(i * symmetry.period(), Eigen::Vector3d::UnitZ()));
  return all;
}

std::vector<Eigen::Isometry3d> ModelSymmetries::motions(int steps) const {
  std::vector<Eigen::Isometry3d> all{Eigen::Isometry3d::Identity()};
  all.insert(all.end(), discrete.begin(), discrete.end());
  const std::size_t apart = all.size();
  for (const Axis& axis : continuous)
    for (int i = 1; i < steps; ++i) {
      const Eigen::Isometry3d turn = Eigen::Translation3d(axis.point) *
                                     Eigen::AngleAxisd(2.0 * std::numbers::pi * i / steps, axis.direction) *
                                     Eigen::Translation3d(-axis.point);
      for (std::size_t m = 0; m < apart; ++m) all.push_back(turn * all[m]);
    }
  return all;
}

bool ModelSymmetries::equal_ups(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double tolerance) const {
  const auto same_around = [&](const Eigen::Vector3d& moved) {
    if (angle_between(moved, b) <= tolerance) return true;
    return std::any_of(continuous.begin(), continuous.end(), [&](const Axis& axis) {
      return std::abs(angle_between(moved, axis.direction) - angle_between(b, axis.direction)) <= tolerance;
    });
  };
  if (same_around(a)) return true;
  return std::any_of(discrete.begin(), discrete.end(), [&](const Eigen::Isometry3d& motion) {
    return same_around(motion.linear() * a) || same_around(motion.linear().transpose() * a);
  });
}

ModelSymmetries::Vertical ModelSymmetries::about_up(const Eigen::Vector3d& up, double tolerance) const {
  const auto is_vertical = [&](const Eigen::Vector3d& direction) {
    const double angle = angle_between(direction, up);
    return std::min(angle, std::numbers::pi - angle) <= tolerance;
  };
  for (const Axis& axis : continuous)
    if (is_vertical(axis.direction)) return {Symmetry::continuous(), axis.point};
  int fold = 1;
  std::optional<Eigen::Vector3d> point;
  for (const Eigen::Isometry3d& motion : discrete) {
    const Eigen::AngleAxisd turn(motion.linear());
    if (std::abs(turn.angle()) <= tolerance || !is_vertical(turn.axis())) continue;
    const int together = std::lcm(fold, fold_of(turn.angle()));
    if (together == fold || together > largest_fold) continue;
    fold = together;
    if (!point) point = fixed_point(motion, turn.axis());
  }
  // A lying solid of revolution whose ends are alike: what swaps them, followed by a turn about its axis, is
  // half a turn about the vertical line through its middle.
  for (const Axis& axis : continuous) {
    if (fold % 2 == 0 || 2 * fold > largest_fold || std::abs(axis.direction.dot(up)) > std::sin(tolerance))
      continue;
    for (const Eigen::Isometry3d& motion : discrete) {
      if (angle_between(motion.linear() * axis.direction, -axis.direction) > tolerance) continue;
      fold *= 2;
      // The middle of the axis: it lies half way between any point of the axis and where that is taken to.
      if (!point) point = 0.5 * (axis.point + motion * axis.point);
      break;
    }
  }
  return {Symmetry::n_fold(fold), point.value_or(Eigen::Vector3d::Zero())};
}

}  // namespace perch
