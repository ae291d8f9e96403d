#include "perch/render/pixel_cells.hpp"

#include <algorithm>

namespace perch {
namespace {

void fill_axis(const std::array<int, lane_count>& offsets, int cells, int origin, int step,
               const std::vector<float>& rays, std::vector<float>& place, std::vector<float>& slope) {
  place.resize(static_cast<std::size_t>(cells) * lane_count);
  slope.resize(place.size());
  const int last = static_cast<int>(rays.size()) - 1;
  std::size_t i = 0;
  for (int cell = 0; cell < cells; ++cell)
    for (const int offset : offsets) {
      const int pixel = origin + cell * step + offset;
      place[i] = static_cast<float>(pixel);
      slope[i] = rays[static_cast<std::size_t>(std::clamp(pixel, 0, last))];
      ++i;
    }
}

}  // namespace

void PixelCells::lay_out(const Shape& of, int cell_columns, int cell_rows, int at_u, int at_v, int apart_u,
                         int apart_v, const std::vector<float>& ray_x, const std::vector<float>& ray_y) {
  shape = of;
  columns = cell_columns;
  rows = cell_rows;
  origin_u = at_u;
  origin_v = at_v;
  step_u = apart_u;
  step_v = apart_v;
  fill_axis(of.u, columns, origin_u, step_u, ray_x, u, slope_x);
  fill_axis(of.v, rows, origin_v, step_v, ray_y, v, slope_y);
  inverse_depth.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows) * lane_count, 0.0F);
}

}  // namespace perch
