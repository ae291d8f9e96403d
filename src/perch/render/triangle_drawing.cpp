#include "perch/render/triangle_drawing.hpp"

#include <cstddef>
#include <cstring>

#include "perch/core/instruction_set.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {
namespace {

using Triangle = TriangleDrawing::Triangle;

/// What the drawing of one mesh goes by.
struct Frame {
  const ProjectedVertex* vertices;
  const Triangle* triangles;
  float left, right, top, bottom;  ///< of the window, inclusive
  float origin_u, origin_v, step_u, step_v;
  float low_u, high_u, low_v, high_v;
  int columns, rows;
  const float *u, *slope_x, *v, *slope_y;  ///< lanes of the columns and rows of cells
  float* cells;                            ///< lanes of the cells
  int block_shift_u, block_shift_v;        ///< 1 << this: cells of a block
  int blocks_across, blocks_down;
  float* farthest;  ///< of each block
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/render/triangle_drawing.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

void TriangleDrawing::draw(const std::vector<ProjectedVertex>& vertices,
                           const std::vector<Triangle>& triangles, const Window& window, PixelCells& cells) {
  const auto number = [](int i) { return static_cast<float>(i); };
  const int across = ((cells.columns - 1) >> cells.shape.block_shift_u) + 1,
            down = ((cells.rows - 1) >> cells.shape.block_shift_v) + 1;
  farthest_.resize(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  later_.resize(triangles.size() + lane_count);
  const Frame frame{vertices.data(),
                    triangles.data(),
                    number(window.u0),
                    number(window.u1 - 1),
                    number(window.v0),
                    number(window.v1 - 1),
                    number(cells.origin_u),
                    number(cells.origin_v),
                    number(cells.step_u),
                    number(cells.step_v),
                    number(cells.shape.low_u),
                    number(cells.shape.high_u),
                    number(cells.shape.low_v),
                    number(cells.shape.high_v),
                    cells.columns,
                    cells.rows,
                    cells.u.data(),
                    cells.slope_x.data(),
                    cells.v.data(),
                    cells.slope_y.data(),
                    cells.inverse_depth.data(),
                    cells.shape.block_shift_u,
                    cells.shape.block_shift_v,
                    across,
                    down,
                    farthest_.data()};
  PERCH_CALL(draw_all, frame, static_cast<std::uint32_t>(triangles.size()), later_.data());
}

}  // namespace perch
