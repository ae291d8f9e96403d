#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "perch/core/camera.hpp"
#include "perch/model/mesh.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// A mesh in the camera frame, all beyond the near plane, drawn one triangle and one pixel at a time, with
/// the rasterizer's operations in their plainest order: what several at a time must equal to the bit. Fills
/// the whole image.
inline DepthPatch reference_drawing(const Mesh& mesh, const Intrinsics& k) {
  const RaySlopes rays(k);
  DepthPatch patch{k.window(), std::vector<float>(static_cast<std::size_t>(k.width * k.height), 0.0F)};
  struct Corner {
    Eigen::Vector3f p;
    float u, v;
  };
  for (const auto& triangle : mesh.triangles) {
    std::array<Corner, 3> corner;
    for (std::size_t i = 0; i < 3; ++i) {
      // As if moved by the identity: 1 x + (0 y + 0 z) + 0.
      const Eigen::Vector3f p = mesh.vertices[triangle[i]];
      const float inverse = 1.0F / p.z();
      corner[i] = {p, static_cast<float>(k.fx) * p.x() * inverse + static_cast<float>(k.cx),
                   static_cast<float>(k.fy) * p.y() * inverse + static_cast<float>(k.cy)};
    }
    const auto& [a, b, c] = corner;
    const float area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
    if (area == 0.0F) continue;
    const Eigen::Vector3f normal = (b.p - a.p).cross(c.p - a.p);
    const float offset = normal.dot(a.p);
    const float nearest = 1.0F / std::min({a.p.z(), b.p.z(), c.p.z()});
    const float farthest = 1.0F / std::max({a.p.z(), b.p.z(), c.p.z()});
    const float scale = offset == 0.0F ? 0.0F : 1.0F / offset;
    const auto limit = [](float x, int size) {
      return static_cast<int>(std::clamp(x, -1.0F, static_cast<float>(size)));
    };
    const int top = std::max(0, limit(std::ceil(std::min({a.v, b.v, c.v})), k.height));
    const int bottom = std::min(k.height - 1, limit(std::floor(std::max({a.v, b.v, c.v})), k.height));
    const int left = std::max(0, limit(std::ceil(std::min({a.u, b.u, c.u})), k.width));
    const int right = std::min(k.width - 1, limit(std::floor(std::max({a.u, b.u, c.u})), k.width));
    for (int v = top; v <= bottom; ++v)
      for (int u = left; u <= right; ++u) {
        bool inside = true;
        for (std::size_t e = 0; e < 3; ++e) {
          const Corner *from = &corner[e], *to = &corner[(e + 1) % 3];
          const bool flipped = to->u < from->u || (to->u == from->u && to->v < from->v);
          if (flipped) std::swap(from, to);
          const float sign = (area > 0.0F) != flipped ? 1.0F : -1.0F;
          const float du = sign * (to->u - from->u), dv = sign * (to->v - from->v);
          inside = inside &&
                   du * (static_cast<float>(v) - from->v) - dv * (static_cast<float>(u) - from->u) >= 0.0F;
        }
        if (!inside) continue;
        const float row = normal.y() * scale * rays.y(v) + (offset == 0.0F ? nearest : normal.z() * scale);
        const float plane = normal.x() * scale * rays.x(u) + row;
        float& drawn = patch.depth[patch.index(u, v)];
        drawn = std::max(drawn, std::min(std::max(plane, farthest), nearest));
      }
  }
  for (float& z : patch.depth) z = z > 0.0F ? 1.0F / z : no_surface;
  return patch;
}

}  // namespace perch
