#include "perch/sim/simulated_scene.hpp"

#include <algorithm>

#include "perch/render/rasterizer.hpp"

namespace perch {

RenderedLayout render_layout(const SceneLayout& layout) {
  const Intrinsics& intrinsics = layout.camera.intrinsics;
  const Eigen::Isometry3d camera_from_world = layout.camera.world_from_camera.inverse();
  Rasterizer rasterizer(intrinsics);
  std::vector<DepthPatch> patches;
  std::vector<const DepthPatch*> all;
  for (const auto& [model, pose] : layout.objects)
    patches.push_back(rasterizer.render(
        layout.models[model].mesh, camera_from_world * world_from_model(pose, layout.models[model].base)));
  for (const DepthPatch& patch : patches) all.push_back(&patch);
  const DepthPatch composite = compose(all);

  RenderedLayout rendered;
  rendered.depth = DepthImage(intrinsics.width, intrinsics.height);
  rendered.objects = Image<std::uint16_t>(intrinsics.width, intrinsics.height);
  for (int v = composite.window.v0; v < composite.window.v1; ++v)
    for (int u = composite.window.u0; u < composite.window.u1; ++u)
      if (const float z = composite.at(u, v); z < no_surface) rendered.depth(u, v) = z;
  for (const DepthPatch& patch : patches) {
    std::int64_t visible = 0;
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u)
        if (patch.at(u, v) < no_surface && patch.at(u, v) == composite.at(u, v)) {
          ++visible;
          std::uint16_t& nearest = rendered.objects(u, v);
          if (nearest == 0) nearest = static_cast<std::uint16_t>(rendered.visible.size() + 1);
        }
    const auto alone = static_cast<std::int64_t>(patch.covered());
    rendered.visible_fractions.push_back(
        alone == 0 ? 0.0 : static_cast<double>(visible) / static_cast<double>(alone));
    rendered.windows.push_back(patch.window);
    rendered.visible.push_back(visible);
    rendered.alone.push_back(alone);
  }
  return rendered;
}

bool clear_of_border(const Window& window, const Intrinsics& intrinsics) {
  return !window.empty() && window.u0 > 0 && window.v0 > 0 && window.u1 < intrinsics.width &&
         window.v1 < intrinsics.height;
}

Scene unobserved_scene(const SceneLayout& layout) {
  Scene scene;
  scene.name = layout.name;
  scene.camera = layout.camera;
  scene.depth_scale = 0.0001;
  scene.table_height = 0.0;
  scene.workspace = layout.workspace;
  scene.models = layout.models;
  for (const auto& [model, pose] : layout.objects) {
    scene.objects.push_back(kind_of(layout.models, model));
    scene.truth.push_back({model, pose, layout.models[model].symmetry});
  }
  return scene;
}

SimulatedScene simulate(const SceneLayout& layout, const DepthSensorSettings& sensor, std::uint64_t seed) {
  RenderedLayout rendered = render_layout(layout);
  SimulatedScene simulated;
  simulated.visible_fractions = std::move(rendered.visible_fractions);
  simulated.scene = unobserved_scene(layout);
  simulated.scene.depth = sense_depth(rendered.depth, layout.camera.intrinsics, sensor, seed);
  return simulated;
}

Camera camera_looking_at(const Intrinsics& intrinsics, const Eigen::Vector3d& eye,
                         const Eigen::Vector3d& target) {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  world_from_camera.linear() << right, forward.cross(right), forward;
  world_from_camera.translation() = eye;
  return {intrinsics, world_from_camera};
}

}  // namespace perch
