#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/random.hpp"
#include "perch/model/object_model.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/refine/icp.hpp"
#include "perch/refine/surface_views.hpp"
#include "perch/refine/visible_samples.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {

/// A closed upright body over a polygon in the plane.
inline Mesh prism(const std::vector<Eigen::Vector2f>& outline, float height) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();
  for (const auto& p : outline) middle += p / static_cast<float>(n);
  for (const float z : {0.0F, height})
    for (const auto& p : outline) mesh.vertices.emplace_back(p.x(), p.y(), z);
  mesh.vertices.emplace_back(middle.x(), middle.y(), 0.0F);
  mesh.vertices.emplace_back(middle.x(), middle.y(), height);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
    mesh.triangles.push_back({j, i, 2 * n});
    mesh.triangles.push_back({n + i, n + j, 2 * n + 1});
  }
  return mesh;
}

inline Mesh wedge() {
  return prism({{-0.05F, -0.03F}, {0.06F, -0.03F}, {0.06F, 0.02F}, {-0.05F, 0.05F}}, 0.12F);
}

/// Over a regular polygon about the origin.
inline Mesh regular_prism(int corners, float radius, float height) {
  std::vector<Eigen::Vector2f> outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    outline.emplace_back((radius * Eigen::Vector2d(std::cos(angle), std::sin(angle))).cast<float>());
  }
  return prism(outline, height);
}

inline Mesh round_can() {
  return regular_prism(64, 0.04F, 0.1F);
}

/// Hides a part of itself from many sides: a post beside a low block.
inline Mesh post_and_block() {
  Mesh mesh = prism({{-0.05F, -0.02F}, {-0.02F, -0.02F}, {-0.02F, 0.02F}, {-0.05F, 0.02F}}, 0.14F);
  const Mesh block = prism({{0.0F, -0.04F}, {0.06F, -0.04F}, {0.06F, 0.04F}, {0.0F, 0.04F}}, 0.05F);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), block.vertices.begin(), block.vertices.end());
  for (const auto& t : block.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return mesh;
}

inline ObjectModel object(const Mesh& mesh, const Symmetry& symmetry = Symmetry::none(),
                          double origin_z = 0.0) {
  return ObjectModel("body", mesh, symmetry, origin_z, 0.01);
}

/// Looks down on the origin from 0.8 m.
inline Camera tilted_camera() {
  Camera c;
  c.intrinsics = {320, 240, 400, 400, 159.5, 119.5};
  const double down = 0.6;
  c.world_from_camera.linear().col(0) = Eigen::Vector3d::UnitX();
  c.world_from_camera.linear().col(1) = Eigen::Vector3d(0, -std::sin(down), -std::cos(down));
  c.world_from_camera.linear().col(2) = Eigen::Vector3d(0, std::cos(down), -std::sin(down));
  c.world_from_camera.translation() = Eigen::Vector3d(0, -0.8 * std::cos(down), 0.8 * std::sin(down));
  return c;
}

/// A camera, what it sees of bodies, and the samples that ICP makes use of.
struct RefineBench {
  Camera camera = tilted_camera();
  Rasterizer rasterizer{camera.intrinsics};
  RefineSettings settings;
  SerialExecutor executor;

  Eigen::Vector3d eye() const { return camera.world_from_camera.translation(); }
  DepthPatch render(const Mesh& mesh, const Pose& pose, double origin_z = 0.0) {
    return rasterizer.render(mesh, camera.world_from_camera.inverse() * world_from_model(pose, origin_z));
  }
  Observation observe(const std::vector<const DepthPatch*>& patches) const {
    const DepthPatch all = compose(patches);
    DepthImage image(camera.intrinsics.width, camera.intrinsics.height);
    for (int v = 0; v < image.height(); ++v)
      for (int u = 0; u < image.width(); ++u)
        if (all.at_or_none(u, v) < no_surface) image(u, v) = all.at_or_none(u, v);
    return Observation(camera, image, std::nullopt);
  }
  Observation observe(const DepthPatch& patch) const { return observe({&patch}); }

  SurfaceViews views(const ObjectModel& model) const {
    return SurfaceViews(model, eye().norm(), settings.samples);
  }
  SurfaceSamples samples(const SurfaceViews& views, const ObjectModel& model, const Pose& pose,
                         const Observation& observation) const {
    const SurfaceViews::View view = views.from(eye(), pose);
    SurfaceSamples found;
    Sight sight;
    visible_samples(view.samples, {pose.x, pose.y, view.yaw}, model.origin_z(), nullptr, observation,
                    settings.occlusion, found, sight);
    return found;
  }
  /// Three rounds of ICP.
  Pose refine(const ObjectModel& model, Pose pose, const Observation& observation, const NearestTable& table,
              double reach) const {
    const SurfaceViews seen = views(model);
    for (int round = 0; round < 3; ++round)
      pose = align(samples(seen, model, pose, observation), pose, model.symmetry().is_continuous(), table,
                   reach, settings)
                 .pose;
    return pose;
  }
};

}  // namespace perch
