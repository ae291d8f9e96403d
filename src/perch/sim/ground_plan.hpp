#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perch/core/pose.hpp"
#include "perch/model/mesh.hpp"

namespace perch {

/// The ground that an object takes up: its mesh seen from above as it is, hollows and gaps between parts
/// included, on a grid of cells of a millimetre, rounded outwards. Objects whose plans lie apart can't touch
/// at any height.
class GroundPlan {
 public:
  static constexpr double cell = 0.001;  ///< metres

  /// In the model's frame. \param reach how far from the object something counts as near, metres, >= 0.
  GroundPlan(const Mesh& mesh, double reach);

  /// True where a triangle lies over the cell that holds the point, or so close that it can't be told.
  bool covers(const Eigen::Vector2d& point) const { return value_at(point) >= covered; }
  /// True where a cell at the point may come within `reach` of the object.
  bool is_near(const Eigen::Vector2d& point) const { return value_at(point) >= near; }
  /// Middles of the covered cells that have one beside them that isn't.
  const std::vector<Eigen::Vector2d>& border() const { return border_; }
  double radius() const { return radius_; }  ///< of the circle about the origin that holds the object, metres
  double reach() const { return reach_; }

 private:
  enum Value : std::uint8_t { far = 0, near = 1, covered = 2 };

  std::uint8_t value_at(const Eigen::Vector2d& point) const;
  void cover(const Eigen::Vector2d (&triangle)[3]);
  void find_border();
  void grow();
  std::uint8_t& value(int i, int j) { return values_[index(i, j)]; }
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(i);
  }

  double reach_;
  double radius_ = 0.0;
  Eigen::Vector2d corner_;  ///< of cell (0, 0)
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> values_;
  std::vector<Eigen::Vector2d> border_;
};

/// True where the two objects stay at least the first one's and the second one's reach (the same) from each
/// other; never true where they don't, and true whenever they stay 4.3 mm more than that apart.
bool apart(const GroundPlan& a, const Pose& world_from_a, const GroundPlan& b, const Pose& world_from_b);

}  // namespace perch
