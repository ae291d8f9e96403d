#pragma once

#include <array>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/instruction_set.hpp"

namespace perch {

/// The pixels that a rendering is made of, in cells of lane_count pixels that are drawn together. Cell (i, j)
/// lies at column origin_u + i step_u and row origin_v + j step_v; all cells have the same shape.
struct PixelCells {
  /// Where the pixels of a cell lie from its place.
  struct Shape {
    std::array<int, lane_count> u, v;
    int low_u, high_u, low_v, high_v;  ///< bounds of u and v
  };
  static constexpr Shape tile{{0, 1, 2, 3, 0, 1, 2, 3}, {0, 0, 0, 0, 1, 1, 1, 1}, 0, 3, 0, 1};
  /// A pixel, its left, right, upper and lower neighbour; the rest repeats the pixel.
  static constexpr Shape cross{{0, -1, 1, 0, 0, 0, 0, 0}, {0, 0, 0, -1, 1, 0, 0, 0}, -1, 1, -1, 1};

  /// Lays out empty cells. Ray slopes are those of the nearest pixel in the image where a cell reaches beyond
  /// it.
  void lay_out(const Shape& of, int cell_columns, int cell_rows, int at_u, int at_v, int apart_u, int apart_v,
               const std::vector<float>& ray_x, const std::vector<float>& ray_y);
  float* cell(int column, int row) { return inverse_depth.data() + offset(column, row); }
  const float* cell(int column, int row) const { return inverse_depth.data() + offset(column, row); }

  Shape shape = tile;
  int columns = 0, rows = 0;
  int origin_u = 0, origin_v = 0, step_u = 1, step_v = 1;
  std::vector<float> u, slope_x;     ///< lanes of each column: pixel column, slope of its ray
  std::vector<float> v, slope_y;     ///< lanes of each row
  std::vector<float> inverse_depth;  ///< lanes of each cell, row-major: 1/z of the nearest surface, 0 = none

 private:
  std::size_t offset(int column, int row) const {
    return (static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
            static_cast<std::size_t>(column)) *
           lane_count;
  }
};

}  // namespace perch
