#include "perch/render/triangle_drawing.hpp"

#include <cstddef>
#include <cstring>

#include "perch/core/instruction_set.hpp"

namespace perch {
namespace {

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
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/render/triangle_drawing.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

void draw_triangles(const std::vector<ProjectedVertex>& vertices, const std::vector<Triangle>& triangles,
                    const Window& window, PixelCells& cells) {
  const auto number = [](int i) { return static_cast<float>(i); };
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
                    cells.inverse_depth.data()};
  PERCH_CALL(draw_all, frame, static_cast<std::uint32_t>(triangles.size()));
}

}  // namespace perch
