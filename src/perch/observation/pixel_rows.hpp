#pragma once

#include <cstdint>
#include <vector>

#include "perch/core/instruction_set.hpp"
#include "perch/observation/observation.hpp"

namespace perch {

/// What is known of each pixel, in rows that may be read lane_count at a time from any column of the image,
/// and from columns that lie a margin beyond it: no point of I is there.
struct PixelRows {
  std::size_t pitch = 0;              ///< from one row to the next; more than the image is wide
  std::size_t before = 0;             ///< places before the first column
  std::vector<float> slope_x;         ///< of the columns' rays, the first at `before`
  std::vector<float> slope_y;         ///< of the rows' rays
  std::vector<float> depth;           ///< of the point of I, 0 = none
  std::vector<std::uint32_t> number;  ///< of the point of I; where there is none, of the next one
  /// The depths at which a point of the pixel's ray can be near a point of I lie between these; infinity and
  /// -infinity where there are none.
  std::vector<float> nearest, farthest;

  /// \param margin columns.
  PixelRows(const Observation& observation, int margin);
  /// Where a row's first pixel is.
  std::size_t row(int v) const { return before + static_cast<std::size_t>(v) * pitch; }
  /// The slope of column 0's ray, and those beside it.
  const float* slopes() const { return slope_x.data() + before; }
};

}  // namespace perch
