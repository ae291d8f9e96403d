#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "perch/observation/observation.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// A point of I near any given point, by one look-up: for each cell of a world-frame grid around I the point
/// nearest to the cell's centre. What it returns is nearest up to the size of a cell; it serves ICP, never a
/// count.
class NearestTable {
 public:
  /// \param reach how far from I a query may lie, metres. Throws Interrupted.
  NearestTable(const Observation& observation, double reach, const Executor& executor,
               const StopCondition& stop = StopCondition());

  /// The point of I (world frame), or nullptr where none lies within about reach.
  const Eigen::Vector3f* lookup(const Eigen::Vector3f& world) const;

  /// The table itself, for loops that look up several at a time. Cell (i, j, k) reaches from origin + cell
  /// (i, j, k) on and has the number (k size_y + j) size_x + i.
  struct Cells {
    float cell, origin_x, origin_y, origin_z;
    int size_x, size_y, size_z;
    const std::int32_t* nearest;  ///< number of each cell's point, -1 = none
    const float* points;          ///< x, y, z of each point
  };
  Cells cells() const {
    static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
    return {cell_,     origin_.x(), origin_.y(),     origin_.z(),           size_.x(),
            size_.y(), size_.z(),   nearest_.data(), points_.front().data()};
  }

 private:
  std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size_.y()) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(i);
  }

  float cell_ = 0.0F;
  Eigen::Vector3f origin_ = Eigen::Vector3f::Zero();  ///< lower corner of cell (0, 0, 0)
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<std::int32_t> nearest_;  ///< number of the point, -1 = none
  std::vector<Eigen::Vector3f> points_;
};

}  // namespace perch
