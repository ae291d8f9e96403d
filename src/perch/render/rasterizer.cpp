#include "perch/render/rasterizer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "perch/core/dispatch.hpp"

namespace perch {
namespace {

/// A run of pixels of one row, worked on together. The compiler maps it to whatever registers the processor
/// has.
constexpr int block = 8;
using Lanes = float __attribute__((vector_size(block * sizeof(float))));
using Mask = std::int32_t __attribute__((vector_size(block * sizeof(std::int32_t))));

/// A triangle ready to be drawn into a window.
struct Triangle {
  /// Twice the signed area of (edge, pixel), sign such that the inside is positive: du (v - v0) - dv (u -
  /// u0). Start and end of an edge are in an order of their own, so that the triangles on its two sides
  /// compute the same number, and a pixel centre on it can't fall between them.
  std::array<float, 3> u0, v0, du, dv;
  float plane_x, plane_y, plane_z;  ///< 1/z = plane . (ray x, ray y, 1)
  float nearest, farthest;          ///< bounds of 1/z
  int left, right, top, bottom;     ///< pixels, inclusive
};

/// Draws into `target`, whose rows are `pitch` apart and start at column `first_column` and row `first_row`.
PERCH_DISPATCH void draw_triangle(const Triangle& t, const float* ray_x, const float* ray_y, int first_column,
                                  int first_row, float* target, std::size_t pitch) {
  constexpr Lanes steps{0, 1, 2, 3, 4, 5, 6, 7};
  const int start = t.left - (t.left - first_column) % block;
  for (int v = t.top; v <= t.bottom; ++v) {
    const float fv = static_cast<float>(v);
    float* row = target + static_cast<std::size_t>(v - first_row) * pitch;
    const float r0 = t.du[0] * (fv - t.v0[0]), r1 = t.du[1] * (fv - t.v0[1]), r2 = t.du[2] * (fv - t.v0[2]);
    const float plane_row = t.plane_y * ray_y[v] + t.plane_z;
    for (int u = start; u <= t.right; u += block) {
      const Lanes fu = static_cast<float>(u) + steps;
      const Lanes e0 = r0 - t.dv[0] * (fu - t.u0[0]), e1 = r1 - t.dv[1] * (fu - t.u0[1]),
                  e2 = r2 - t.dv[2] * (fu - t.u0[2]);
      const Mask inside = (e0 >= 0.0F) & (e1 >= 0.0F) & (e2 >= 0.0F);
      Lanes slopes, drawn;
      std::memcpy(&slopes, ray_x + u, sizeof slopes);
      std::memcpy(&drawn, row + (u - first_column), sizeof drawn);
      Lanes inverse_depth = t.plane_x * slopes + plane_row;
      inverse_depth = inverse_depth < t.farthest ? Lanes{} + t.farthest : inverse_depth;
      inverse_depth = inverse_depth > t.nearest ? Lanes{} + t.nearest : inverse_depth;
      drawn = inside & (inverse_depth > drawn) ? inverse_depth : drawn;
      std::memcpy(row + (u - first_column), &drawn, sizeof drawn);
    }
  }
}

}  // namespace

Rasterizer::Rasterizer(const Intrinsics& intrinsics)
    : intrinsics_(intrinsics),
      ray_x_(static_cast<std::size_t>(intrinsics.width + block), 0.0F),
      ray_y_(static_cast<std::size_t>(intrinsics.height), 0.0F) {
  const RaySlopes rays(intrinsics);
  for (int u = 0; u < intrinsics.width; ++u) ray_x_[static_cast<std::size_t>(u)] = rays.x(u);
  for (int v = 0; v < intrinsics.height; ++v) ray_y_[static_cast<std::size_t>(v)] = rays.y(v);
}

Rasterizer::Vertex Rasterizer::project(const Eigen::Vector3f& point) const {
  const float inverse = 1.0F / point.z();
  return {point,
          static_cast<float>(intrinsics_.fx) * point.x() * inverse + static_cast<float>(intrinsics_.cx),
          static_cast<float>(intrinsics_.fy) * point.y() * inverse + static_cast<float>(intrinsics_.cy)};
}

DepthPatch Rasterizer::render(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model) {
  DepthPatch patch;
  render(mesh, camera_from_model, patch);
  return patch;
}

void Rasterizer::render(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model, DepthPatch& patch) {
  const Eigen::Matrix3f rotation = camera_from_model.linear().cast<float>();
  const Eigen::Vector3f translation = camera_from_model.translation().cast<float>();
  vertices_.resize(mesh.vertices.size());
  float u_min = no_surface, v_min = no_surface, u_max = -no_surface, v_max = -no_surface;
  bool crosses_near = false;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    Vertex& vertex = vertices_[i];
    vertex.point = rotation * mesh.vertices[i] + translation;
    if (vertex.point.z() < near_plane) {
      crosses_near = true;
      continue;
    }
    vertex = project(vertex.point);
    u_min = std::min(u_min, vertex.u);
    u_max = std::max(u_max, vertex.u);
    v_min = std::min(v_min, vertex.v);
    v_max = std::max(v_max, vertex.v);
  }
  // A mesh that reaches behind the near plane may cover any part of the image.
  const auto pixel = [](float x, int limit) {
    return static_cast<int>(std::clamp(x, -1.0F, static_cast<float>(limit) + 1.0F));
  };
  patch.window = intrinsics_.window();
  if (!crosses_near)
    patch.window = intersection(
        patch.window,
        {pixel(std::ceil(u_min), intrinsics_.width), pixel(std::ceil(v_min), intrinsics_.height),
         pixel(std::floor(u_max), intrinsics_.width) + 1, pixel(std::floor(v_max), intrinsics_.height) + 1});
  const bool all_behind = u_min > u_max;
  if (all_behind || patch.window.empty()) {
    patch.window = {};
    patch.depth.clear();
    return;
  }

  // While drawing, the buffer holds 1/z: that is what is linear in the image, and the nearest surface has the
  // most.
  const Window window = patch.window;
  const std::size_t width = static_cast<std::size_t>(window.width());
  pitch_ = (width + block - 1) / block * block;
  inverse_depth_.assign(pitch_ * static_cast<std::size_t>(window.height()), 0.0F);
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vertex &a = vertices_[ia], &b = vertices_[ib], &c = vertices_[ic];
    if (crosses_near && (a.point.z() < near_plane || b.point.z() < near_plane || c.point.z() < near_plane))
      clip_and_draw({a.point, b.point, c.point}, window);
    else
      draw(a, b, c, window);
  }
  patch.depth.resize(width * static_cast<std::size_t>(window.height()));
  for (std::size_t row = 0; row < static_cast<std::size_t>(window.height()); ++row) {
    const float* source = inverse_depth_.data() + row * pitch_;
    float* target = patch.depth.data() + row * width;
    for (std::size_t i = 0; i < width; ++i) target[i] = source[i] > 0.0F ? 1.0F / source[i] : no_surface;
  }
}

void Rasterizer::clip_and_draw(const std::array<Eigen::Vector3f, 3>& corners, const Window& window) {
  std::array<Vertex, 4> polygon;
  std::size_t n = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3f &p = corners[i], &q = corners[(i + 1) % 3];
    const bool p_visible = p.z() >= near_plane, q_visible = q.z() >= near_plane;
    if (p_visible) polygon[n++] = project(p);
    if (p_visible != q_visible) {
      // Always from the visible end, so that both triangles at this edge cut it at the same point.
      const Eigen::Vector3f &from = p_visible ? p : q, &to = p_visible ? q : p;
      Eigen::Vector3f cut = from + (to - from) * ((near_plane - from.z()) / (to.z() - from.z()));
      cut.z() = near_plane;
      polygon[n++] = project(cut);
    }
  }
  for (std::size_t i = 2; i < n; ++i) draw(polygon[0], polygon[i - 1], polygon[i], window);
}

void Rasterizer::draw(const Vertex& a, const Vertex& b, const Vertex& c, const Window& window) {
  const float left = std::max(std::ceil(std::min({a.u, b.u, c.u})), static_cast<float>(window.u0));
  const float right = std::min(std::floor(std::max({a.u, b.u, c.u})), static_cast<float>(window.u1 - 1));
  const float top = std::max(std::ceil(std::min({a.v, b.v, c.v})), static_cast<float>(window.v0));
  const float bottom = std::min(std::floor(std::max({a.v, b.v, c.v})), static_cast<float>(window.v1 - 1));
  if (!(left <= right && top <= bottom)) return;
  const float area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
  if (area == 0.0F) return;

  Triangle t;
  t.left = static_cast<int>(left);
  t.right = static_cast<int>(right);
  t.top = static_cast<int>(top);
  t.bottom = static_cast<int>(bottom);
  const std::array<const Vertex*, 4> corners{&a, &b, &c, &a};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vertex *from = corners[k], *to = corners[k + 1];
    const bool flipped = to->u < from->u || (to->u == from->u && to->v < from->v);
    if (flipped) std::swap(from, to);
    const float sign = (area > 0.0F) != flipped ? 1.0F : -1.0F;
    t.u0[k] = from->u;
    t.v0[k] = from->v;
    t.du[k] = sign * (to->u - from->u);
    t.dv[k] = sign * (to->v - from->v);
  }
  // The plane n . X = n . a meets the ray (x, y, 1) z at 1/z = n . (x, y, 1) / (n . a). Kept to the
  // triangle's own depths, since an edge-on plane is ill-conditioned.
  const Eigen::Vector3f normal = (b.point - a.point).cross(c.point - a.point);
  const float offset = normal.dot(a.point);
  t.nearest = 1.0F / std::min({a.point.z(), b.point.z(), c.point.z()});
  t.farthest = 1.0F / std::max({a.point.z(), b.point.z(), c.point.z()});
  const bool edge_on = offset == 0.0F;
  const float scale = edge_on ? 0.0F : 1.0F / offset;
  t.plane_x = normal.x() * scale;
  t.plane_y = normal.y() * scale;
  t.plane_z = edge_on ? t.nearest : normal.z() * scale;
  draw_triangle(t, ray_x_.data(), ray_y_.data(), window.u0, window.v0, inverse_depth_.data(), pitch_);
}

}  // namespace perch
