#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "perch/render/pixel_cells.hpp"
#include "perch/render/projection.hpp"

namespace perch {

using Triangle = std::array<std::uint32_t, 3>;

/// Draws triangles into cells of pixels: exactly at pixel centres, edges included, the nearest surface wins.
/// Pixels of the cells outside their window are left alone. \param vertices all at or beyond the near plane.
void draw_triangles(const std::vector<ProjectedVertex>& vertices, const std::vector<Triangle>& triangles,
                    PixelCells& cells);

}  // namespace perch
