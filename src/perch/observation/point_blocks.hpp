#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perch/observation/observation.hpp"

namespace perch {

/// The points of I in small groups of neighbouring pixels, each within a ball, so that a question to many
/// points can be put to a few balls first.
class PointBlocks {
 public:
  /// \param radius that balls are meant to have, metres; none is larger.
  PointBlocks(const Observation& observation, double radius);

  std::size_t size() const { return size_; }
  /// Centres (camera frame) and radii of the balls, metres, by rows of groups; may be read lane_count at a
  /// time from any.
  const std::vector<float>& x() const { return x_; }
  const std::vector<float>& y() const { return y_; }
  const std::vector<float>& z() const { return z_; }
  const std::vector<float>& radius() const { return radius_; }

  struct Range {
    std::size_t first = 0, last = 0;
  };
  /// The blocks with a point in the window are among these, a range for each row of groups.
  template <typename Visit>
  void for_each_range(const Window& window, Visit visit) const {
    const Window w = intersection(window, window_);
    if (w.empty()) return;
    for (int row = w.v0 / pixels_; row <= (w.v1 - 1) / pixels_; ++row)
      visit(Range{first_[cell(w.u0 / pixels_, row)], first_[cell((w.u1 - 1) / pixels_, row) + 1]});
  }

  /// Sums of the points' values, block by block.
  template <typename Value>
  std::vector<Value> sums(const std::vector<Value>& of_points) const {
    std::vector<Value> sums(size_, Value{});
    for (std::size_t i = 0; i < block_.size(); ++i) sums[block_[i]] += of_points[i];
    return sums;
  }

 private:
  std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }

  int pixels_ = 1;  ///< that a group is wide and high
  int columns_ = 0;
  Window window_;
  std::size_t size_ = 0;
  std::vector<float> x_, y_, z_, radius_;  ///< with lane_count more at the end
  std::vector<std::size_t> first_;         ///< of the blocks of a group, row by row
  std::vector<std::uint32_t> block_;       ///< of each point
};

}  // namespace perch
