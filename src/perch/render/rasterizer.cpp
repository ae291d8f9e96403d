#include "perch/render/rasterizer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "perch/core/instruction_set.hpp"

#define PERCH_KERNELS "perch/render/rasterizer.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

Rasterizer::Rasterizer(const Intrinsics& intrinsics)
    : intrinsics_(intrinsics),
      ray_x_(static_cast<std::size_t>(intrinsics.width)),
      ray_y_(static_cast<std::size_t>(intrinsics.height)) {
  const RaySlopes rays(intrinsics);
  for (int u = 0; u < intrinsics.width; ++u) ray_x_[static_cast<std::size_t>(u)] = rays.x(u);
  for (int v = 0; v < intrinsics.height; ++v) ray_y_[static_cast<std::size_t>(v)] = rays.y(v);
}

DepthPatch Rasterizer::render(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model) {
  DepthPatch patch;
  render(mesh, camera_from_model, patch);
  return patch;
}

void Rasterizer::render(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model, DepthPatch& patch) {
  draw(project_mesh(mesh, camera_from_model), patch);
}

Window Rasterizer::project_mesh(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model) {
  const ProjectedBounds bounds =
      project_all(mesh.vertices, camera_from_model, intrinsics_, near_plane, vertices_);
  const bool all_behind = bounds.u_min > bounds.u_max;
  if (all_behind) return {};
  triangles_ = &mesh.triangles;
  if (bounds.crosses_near) {
    // It may cover any part of the image.
    clip(mesh);
    triangles_ = &clipped_;
    return intrinsics_.window();
  }
  const auto pixel = [](float x, int limit) {
    return static_cast<int>(std::clamp(x, -1.0F, static_cast<float>(limit) + 1.0F));
  };
  return intersection(intrinsics_.window(), {pixel(std::ceil(bounds.u_min), intrinsics_.width),
                                             pixel(std::ceil(bounds.v_min), intrinsics_.height),
                                             pixel(std::floor(bounds.u_max), intrinsics_.width) + 1,
                                             pixel(std::floor(bounds.v_max), intrinsics_.height) + 1});
}

void Rasterizer::draw(const Window& window, DepthPatch& patch) {
  if (window.empty()) {
    patch.window = {};
    patch.depth.clear();
    return;
  }
  patch.window = window;
  cells_.lay_out(window, ray_x_, ray_y_);
  draw_triangles(vertices_, *triangles_, cells_);
  patch.depth.resize(static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height()));
  PERCH_CALL(unpack, cells_.inverse_depth.data(), cells_.rows, window.width(), window.height(),
             patch.depth.data());
}

void Rasterizer::clip(const Mesh& mesh) {
  clipped_.clear();
  for (const Triangle& triangle : mesh.triangles) {
    std::array<std::uint32_t, 4> polygon{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const ProjectedVertex p = vertices_[triangle[i]], q = vertices_[triangle[(i + 1) % 3]];
      const bool p_visible = p.z >= near_plane, q_visible = q.z >= near_plane;
      if (p_visible) polygon[n++] = triangle[i];
      if (p_visible != q_visible) {
        // Always from the visible end, so that both triangles at this edge cut it at the same point.
        const ProjectedVertex &from = p_visible ? p : q, &to = p_visible ? q : p;
        const Eigen::Vector3f start(from.x, from.y, from.z), end(to.x, to.y, to.z);
        Eigen::Vector3f cut = start + (end - start) * ((near_plane - from.z) / (to.z - from.z));
        cut.z() = near_plane;
        polygon[n++] = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(project(cut, intrinsics_));
      }
    }
    for (std::size_t i = 2; i < n; ++i) clipped_.push_back({polygon[0], polygon[i - 1], polygon[i]});
  }
}

}  // namespace perch
