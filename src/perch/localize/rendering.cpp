#include "perch/localize/rendering.hpp"

#include <algorithm>
#include <stdexcept>

#include "perch/cost/explanation_cost.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/setup.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

/// Where each object's model stands, camera frame.
std::vector<Eigen::Isometry3d> camera_poses(const Scene& scene, const std::vector<PlacedModel>& placed) {
  const double table = table_height(scene);
  const Eigen::Isometry3d camera_from_world = scene.camera.world_from_camera.inverse();
  std::vector<Eigen::Isometry3d> poses;
  for (const PlacedModel& object : placed)
    poses.push_back(camera_from_world *
                    world_from_model(object.pose, table + scene.models[object.model].base));
  return poses;
}

/// Hands every object's patch to `use(index, patch)`, in order. A few are rendered at a time: all of them
/// at once would need the memory of as many images.
template <typename Use>
void render_in_order(const Scene& scene, const std::vector<PlacedModel>& placed, const Executor& executor,
                     Use use) {
  const std::vector<Eigen::Isometry3d> camera_from_model = camera_poses(scene, placed);
  const std::size_t batch = std::max<std::size_t>(1, executor.workers());
  std::vector<Rasterizer> rasterizers(batch, Rasterizer(scene.camera.intrinsics));
  std::vector<DepthPatch> patches(batch);
  for (std::size_t first = 0; first < placed.size(); first += batch) {
    const std::size_t n = std::min(batch, placed.size() - first);
    executor.for_each(
        n,
        [&](std::size_t i, std::size_t worker) {
          rasterizers[worker].render(scene.models[placed[first + i].model].mesh, camera_from_model[first + i],
                                     patches[i]);
        },
        StopCondition());
    for (std::size_t i = 0; i < n; ++i) use(first + i, patches[i]);
  }
}

void draw(std::size_t object, const DepthPatch& patch, SceneRendering& rendering) {
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u) {
      const float z = patch.at(u, v);
      float& nearest = rendering.depth(u, v);
      if (!(z < no_surface) || (nearest > 0.0F && !(z < nearest))) continue;
      nearest = z;
      rendering.object(u, v) = static_cast<std::uint32_t>(object);
    }
}

void flag(const ExplanationCost& cost, const Composite& composite, SceneRendering& rendering) {
  const Observation& observation = cost.observation();
  for (int v = 0; v < rendering.depth.height(); ++v) {
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i) {
      rendering.observed(observation.column(i), v) = 1;
      rendering.observed_unexplained(observation.column(i), v) =
          cost.charges_points() && !composite.observed.contains(i);
    }
    for (int u = 0; u < rendering.depth.width(); ++u) {
      if (!(rendering.depth(u, v) > 0.0F)) continue;
      rendering.left_out(u, v) = !cost.counts_at(u, v, rendering.depth(u, v));
      rendering.rendered_unexplained(u, v) =
          !rendering.left_out(u, v) && !composite.explained[composite.depth.index(u, v)];
    }
  }
}

std::int64_t flagged(const Image<std::uint8_t>& flags) {
  return std::count(flags.data().begin(), flags.data().end(), 1);
}

}  // namespace

SceneRendering render_scene(const Scene& scene, const std::vector<PlacedModel>& placed,
                            const Settings& settings, const Executor& executor) {
  settings.check();
  const CostSettings counted = cost_settings(scene, settings);
  const Observation observation(scene.camera, scene.depth, scene.mask);
  const DeltaIndex index(observation, counted.delta, executor);
  const ExplanationCost cost(observation, index, counted);

  const int width = scene.depth.width(), height = scene.depth.height();
  const Image<std::uint8_t> unset(width, height, 0);
  SceneRendering rendering{.depth = DepthImage(width, height, 0.0F),
                           .object = Image<std::uint32_t>(width, height, SceneRendering::no_object),
                           .observed = unset,
                           .observed_unexplained = unset,
                           .rendered_unexplained = unset,
                           .left_out = unset,
                           .cost = {}};
  Composite composite = cost.empty();
  CostChange scratch;
  render_in_order(scene, placed, executor, [&](std::size_t object, const DepthPatch& patch) {
    draw(object, patch, rendering);
    cost.add(composite, patch, scratch);
  });
  flag(cost, composite, rendering);
  rendering.cost.cost_observed = flagged(rendering.observed_unexplained);
  rendering.cost.cost_rendered = flagged(rendering.rendered_unexplained);
  rendering.cost.cost = rendering.cost.cost_observed + rendering.cost.cost_rendered;
  return rendering;
}

std::vector<PlacedModel> placed_objects(const Scene& scene, const Result& result) {
  std::vector<PlacedModel> placed;
  for (const ObjectResult& object : result.objects) {
    if (object.absent) continue;
    const auto model = std::find_if(scene.models.begin(), scene.models.end(),
                                    [&](const SceneModel& m) { return m.name == object.model; });
    if (model == scene.models.end())
      throw std::logic_error("placed_objects: the scene has no model " + object.model);
    const auto first = static_cast<std::size_t>(model - scene.models.begin());
    const auto rest = static_cast<std::size_t>(object.rest_pose.value_or(0));
    if (rest >= rest_pose_count(scene.models, first))
      throw std::logic_error("placed_objects: the scene has no such rest pose of " + object.model);
    placed.push_back({first + rest, object.pose});
  }
  return placed;
}

}  // namespace perch
