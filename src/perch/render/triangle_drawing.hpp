#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/render/pixel_cells.hpp"
#include "perch/render/projection.hpp"

namespace perch {

using Triangle = std::array<std::uint32_t, 3>;

/// Draws triangles into cells of pixels: exactly at pixel centres, edges included, the nearest surface wins.
/// \param vertices all at or beyond the near plane. \param window pixels outside it are left alone.
void draw_triangles(const std::vector<ProjectedVertex>& vertices, const std::vector<Triangle>& triangles,
                    const Window& window, PixelCells& cells);

}  // namespace perch
