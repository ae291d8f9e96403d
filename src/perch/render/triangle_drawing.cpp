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
  float left, right, top, bottom;          ///< of the window, inclusive
  int columns;                             ///< of cells
  const float *u, *slope_x, *v, *slope_y;  ///< lanes of the columns and rows of cells
  float* cells;                            ///< lanes of the cells
};

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/render/triangle_drawing.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

void draw_triangles(const std::vector<ProjectedVertex>& vertices, const std::vector<Triangle>& triangles,
                    PixelCells& cells) {
  const Window& window = cells.window;
  const auto number = [](int i) { return static_cast<float>(i); };
  const Frame frame{vertices.data(),       triangles.data(),     number(window.u0),
                    number(window.u1 - 1), number(window.v0),    number(window.v1 - 1),
                    cells.columns,         cells.u.data(),       cells.slope_x.data(),
                    cells.v.data(),        cells.slope_y.data(), cells.inverse_depth.data()};
  PERCH_CALL(draw_all, frame, static_cast<std::uint32_t>(triangles.size()));
}

}  // namespace perch
