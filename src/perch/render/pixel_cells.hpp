#pragma once

#include <vector>

#include "perch/core/image.hpp"
#include "perch/core/instruction_set.hpp"

namespace perch {

/// The pixels that a rendering is made of, in cells of lane_count pixels that are drawn together: 4 columns
/// of 2 rows. Cell (i, j) lies at column window.u0 + 4 i and row window.v0 + 2 j; the last ones may reach
/// beyond the window.
struct PixelCells {
  static constexpr int cell_width = 4, cell_height = 2;  ///< pixels

  /// Lays out empty cells over a window. Ray slopes are those of the nearest pixel in the image where a cell
  /// reaches beyond it.
  void lay_out(const Window& over, const std::vector<float>& ray_x, const std::vector<float>& ray_y);

  Window window;
  int columns = 0, rows = 0;
  std::vector<float> u, slope_x;     ///< lanes of each column: pixel column, slope of its ray
  std::vector<float> v, slope_y;     ///< lanes of each row
  std::vector<float> inverse_depth;  ///< lanes of each cell, row-major: 1/z of the nearest surface, 0 = none
};

}  // namespace perch
