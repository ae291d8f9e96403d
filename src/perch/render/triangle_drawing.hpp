#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/render/pixel_cells.hpp"
#include "perch/render/projection.hpp"

namespace perch {

/// Draws triangles into cells of pixels: exactly at pixel centres, edges included, the nearest surface wins.
/// Memory that is kept from call to call.
class TriangleDrawing {
 public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// \param vertices all at or beyond the near plane. \param window pixels outside it are left alone.
  void draw(const std::vector<ProjectedVertex>& vertices, const std::vector<Triangle>& triangles,
            const Window& window, PixelCells& cells);

 private:
  std::vector<std::uint32_t> later_;  ///< triangles that turn away
  std::vector<float> farthest_;       ///< least 1/z of each block of cells
};

}  // namespace perch
