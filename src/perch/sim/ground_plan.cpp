#include "perch/sim/ground_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace perch {
namespace {

Eigen::Vector2d turned_by(const Eigen::Vector2d& p, double cosine, double sine) {
  return {cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y()};
}

/// True where a border cell of one object comes near the other.
bool meets(const GroundPlan& a, const Pose& world_from_a, const GroundPlan& b, const Pose& world_from_b) {
  const double yaw = world_from_a.yaw - world_from_b.yaw;
  const double cosine = std::cos(yaw), sine = std::sin(yaw);
  const Eigen::Vector2d shift = turned_by({world_from_a.x - world_from_b.x, world_from_a.y - world_from_b.y},
                                          std::cos(world_from_b.yaw), -std::sin(world_from_b.yaw));
  return std::any_of(a.border().begin(), a.border().end(),
                     [&](const Eigen::Vector2d& p) { return b.is_near(turned_by(p, cosine, sine) + shift); });
}

}  // namespace

GroundPlan::GroundPlan(const Mesh& mesh, double reach) : reach_(reach) {
  const Eigen::AlignedBox3f bounds = mesh.bounds();
  const int margin = static_cast<int>(std::ceil(reach / cell)) + 4;
  const Eigen::Vector2d least = bounds.min().head<2>().cast<double>(),
                        most = bounds.max().head<2>().cast<double>();
  corner_ = least.array() - margin * cell;
  columns_ = static_cast<int>((most.x() - least.x()) / cell) + 1 + 2 * margin;
  rows_ = static_cast<int>((most.y() - least.y()) / cell) + 1 + 2 * margin;
  values_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), far);
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    radius_ = std::max(radius_, static_cast<double>(vertex.head<2>().norm()));
  for (const auto& corners : mesh.triangles) {
    Eigen::Vector2d triangle[3];
    for (std::size_t k = 0; k < 3; ++k)
      triangle[k] = (mesh.vertices[corners[k]].head<2>().cast<double>() - corner_) / cell;
    cover(triangle);
  }
  find_border();
  grow();
}

std::uint8_t GroundPlan::value_at(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d at = (point - corner_) / cell;
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < columns_ && at.y() < rows_)) return far;
  return values_[index(static_cast<int>(at.x()), static_cast<int>(at.y()))];
}

/// Marks every cell that a triangle (in cells) touches: row by row, from the leftmost to the rightmost point
/// of what lies within the row.
void GroundPlan::cover(const Eigen::Vector2d (&triangle)[3]) {
  constexpr double slack = 1e-6;  // cells; what lies on a line between two is in both
  const auto [lowest, highest] = std::minmax({triangle[0].y(), triangle[1].y(), triangle[2].y()});
  for (int j = static_cast<int>(lowest - slack); j <= static_cast<int>(highest + slack); ++j) {
    double left = std::numeric_limits<double>::infinity(), right = -left;
    const auto include = [&](double x) {
      left = std::min(left, x);
      right = std::max(right, x);
    };
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d &p = triangle[k], &q = triangle[(k + 1) % 3];
      if (p.y() >= j - slack && p.y() <= j + 1 + slack) include(p.x());
      for (const double line : {static_cast<double>(j), j + 1.0})
        if ((p.y() - line) * (q.y() - line) < 0.0)
          include(p.x() + (q.x() - p.x()) * (line - p.y()) / (q.y() - p.y()));
    }
    if (left > right) continue;
    for (int i = static_cast<int>(left - slack); i <= static_cast<int>(right + slack); ++i)
      value(i, j) = covered;
  }
}

void GroundPlan::find_border() {
  // The margin is empty, so every covered cell has its neighbours in the grid.
  for (int j = 1; j + 1 < rows_; ++j)
    for (int i = 1; i + 1 < columns_; ++i)
      if (value(i, j) == covered && (value(i - 1, j) != covered || value(i + 1, j) != covered ||
                                     value(i, j - 1) != covered || value(i, j + 1) != covered))
        border_.push_back(corner_ + cell * Eigen::Vector2d(i + 0.5, j + 0.5));
}

void GroundPlan::grow() {
  // From a point in a cell here to the middle of one there, each half a diagonal from what it stands for.
  const double far_enough = reach_ / cell + std::numbers::sqrt2 + 0.5 * std::numbers::sqrt2;
  const int steps = static_cast<int>(std::ceil(far_enough));
  for (const Eigen::Vector2d& middle : border_) {
    const Eigen::Vector2d at = (middle - corner_) / cell;
    const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
    for (int j = std::max(0, row - steps); j <= std::min(rows_ - 1, row + steps); ++j)
      for (int i = std::max(0, column - steps); i <= std::min(columns_ - 1, column + steps); ++i)
        if (value(i, j) == far && std::hypot(i - column, j - row) <= far_enough) value(i, j) = near;
  }
}

bool apart(const GroundPlan& a, const Pose& world_from_a, const GroundPlan& b, const Pose& world_from_b) {
  const double distance = std::hypot(world_from_a.x - world_from_b.x, world_from_a.y - world_from_b.y);
  if (distance > a.radius() + b.radius() + std::max(a.reach(), b.reach())) return true;
  return !meets(a, world_from_a, b, world_from_b) && !meets(b, world_from_b, a, world_from_a);
}

}  // namespace perch
