#include "perch/render/rasterizer.hpp"

#include <algorithm>
#include <cmath>

namespace perch {
namespace {

/// Twice the signed area of (a, b, pixel), with a and b in an order of their own: the triangles on the two
/// sides of an edge then compute the same number, and a pixel centre on it can't fall between them.
struct EdgeFunction {
  float u0, v0, du, dv;
  bool flipped;

  EdgeFunction(float au, float av, float bu, float bv) : flipped(bu < au || (bu == au && bv < av)) {
    if (flipped) {
      std::swap(au, bu);
      std::swap(av, bv);
    }
    u0 = au;
    v0 = av;
    du = bu - au;
    dv = bv - av;
  }
};

}  // namespace

Rasterizer::Rasterizer(const Intrinsics& intrinsics) : intrinsics_(intrinsics), rays_(intrinsics) {}

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
  if (!crosses_near && u_min <= u_max)
    patch.window = intersection(
        patch.window,
        {pixel(std::ceil(u_min), intrinsics_.width), pixel(std::ceil(v_min), intrinsics_.height),
         pixel(std::floor(u_max), intrinsics_.width) + 1, pixel(std::floor(v_max), intrinsics_.height) + 1});
  if (patch.window.empty() || mesh.vertices.empty()) {
    patch.window = {};
    patch.depth.clear();
    return;
  }

  // While drawing, the patch holds 1/z, 0 = nothing: that is what is linear in the image, and the nearest has
  // the most.
  patch.depth.assign(
      static_cast<std::size_t>(patch.window.width()) * static_cast<std::size_t>(patch.window.height()), 0.0F);
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Vertex &a = vertices_[ia], &b = vertices_[ib], &c = vertices_[ic];
    if (crosses_near && (a.point.z() < near_plane || b.point.z() < near_plane || c.point.z() < near_plane))
      clip_and_draw({a.point, b.point, c.point}, patch);
    else
      draw(a, b, c, patch);
  }
  for (float& z : patch.depth) z = z > 0.0F ? 1.0F / z : no_surface;
}

void Rasterizer::clip_and_draw(const std::array<Eigen::Vector3f, 3>& corners, DepthPatch& patch) const {
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
  for (std::size_t i = 2; i < n; ++i) draw(polygon[0], polygon[i - 1], polygon[i], patch);
}

void Rasterizer::draw(const Vertex& a, const Vertex& b, const Vertex& c, DepthPatch& patch) const {
  const Window& window = patch.window;
  const float left = std::max(std::ceil(std::min({a.u, b.u, c.u})), static_cast<float>(window.u0));
  const float right = std::min(std::floor(std::max({a.u, b.u, c.u})), static_cast<float>(window.u1 - 1));
  const float top = std::max(std::ceil(std::min({a.v, b.v, c.v})), static_cast<float>(window.v0));
  const float bottom = std::min(std::floor(std::max({a.v, b.v, c.v})), static_cast<float>(window.v1 - 1));
  if (!(left <= right && top <= bottom)) return;

  const float area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
  if (area == 0.0F) return;
  const std::array<EdgeFunction, 3> edges{EdgeFunction(a.u, a.v, b.u, b.v), EdgeFunction(b.u, b.v, c.u, c.v),
                                          EdgeFunction(c.u, c.v, a.u, a.v)};
  std::array<float, 3> sign;
  for (std::size_t k = 0; k < 3; ++k) sign[k] = (area > 0.0F) != edges[k].flipped ? 1.0F : -1.0F;

  // The plane n . X = n . a meets the ray (x, y, 1) z at 1/z = n . (x, y, 1) / (n . a). Kept to the
  // triangle's own depths, since an edge-on plane is ill-conditioned.
  const Eigen::Vector3f normal = (b.point - a.point).cross(c.point - a.point);
  const float offset = normal.dot(a.point);
  const float nearest = 1.0F / std::min({a.point.z(), b.point.z(), c.point.z()});
  const float farthest = 1.0F / std::max({a.point.z(), b.point.z(), c.point.z()});
  const bool edge_on = offset == 0.0F;
  const Eigen::Vector3f plane = edge_on ? Eigen::Vector3f(0, 0, nearest) : Eigen::Vector3f(normal / offset);

  const int u0 = static_cast<int>(left), u1 = static_cast<int>(right);
  for (int v = static_cast<int>(top); v <= static_cast<int>(bottom); ++v) {
    const float fv = static_cast<float>(v);
    float* row = patch.depth.data() + patch.index(window.u0, v) - window.u0;
    const float r0 = edges[0].du * (fv - edges[0].v0), r1 = edges[1].du * (fv - edges[1].v0),
                r2 = edges[2].du * (fv - edges[2].v0);
    const float plane_row = plane.y() * rays_.y(v) + plane.z();
    for (int u = u0; u <= u1; ++u) {
      const float fu = static_cast<float>(u);
      const float e0 = sign[0] * (r0 - edges[0].dv * (fu - edges[0].u0));
      const float e1 = sign[1] * (r1 - edges[1].dv * (fu - edges[1].u0));
      const float e2 = sign[2] * (r2 - edges[2].dv * (fu - edges[2].u0));
      if (e0 < 0.0F || e1 < 0.0F || e2 < 0.0F) continue;
      const float inverse_depth = std::clamp(plane.x() * rays_.x(u) + plane_row, farthest, nearest);
      row[u] = std::max(row[u], inverse_depth);
    }
  }
}

}  // namespace perch
