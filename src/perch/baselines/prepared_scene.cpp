#include "perch/baselines/prepared_scene.hpp"

#include <algorithm>
#include <optional>

#include "perch/observation/extent.hpp"

namespace perch {
namespace {

constexpr double field_margin = 0.01;  // metres; collisions look at a solid's inside alone

std::vector<ObjectModel> models_of(const Scene& scene, double table, const Executor& executor,
                                   const StopCondition& stop) {
  std::vector<std::optional<ObjectModel>> made(scene.models.size());
  const auto make = [&](std::size_t i, std::size_t) {
    const SceneModel& model = scene.models[i];
    made[i].emplace(model.name, model.mesh, model.symmetry, table + model.base, field_margin, executor, stop);
  };
  if (!executor.for_each(made.size(), make, stop)) throw Interrupted();
  std::vector<ObjectModel> models;
  models.reserve(made.size());
  for (auto& model : made) models.push_back(std::move(*model));
  return models;
}

/// A circle on the support plane, metres.
struct Circle {
  Eigen::Vector2d middle;
  double radius;
};

/// As wide as the narrower side of the model's bounds, in their middle.
Circle inscribed_circle(const ObjectModel& model, const Pose& pose) {
  const Eigen::AlignedBox3d bounds = model.bounds().cast<double>();
  return {(model.world_from_model(pose) * bounds.center()).head<2>(),
          0.5 * bounds.sizes().head<2>().minCoeff()};
}

}  // namespace

Pose PreparedScene::admitted(std::size_t model, Pose pose) const {
  const Workspace& w = workspaces[model];
  return {std::clamp(pose.x, w.x_min, w.x_max), std::clamp(pose.y, w.y_min, w.y_max),
          models[model].symmetry().canonical_yaw(pose.yaw)};
}

bool PreparedScene::collide(std::size_t a, const Pose& pose_a, std::size_t b, const Pose& pose_b,
                            const CollisionSettings& settings) const {
  const ObjectModel &first = models[a], &second = models[b];
  const double common_height =
      std::min(first.origin_z() + first.height(), second.origin_z() + second.height()) -
      std::max(first.origin_z(), second.origin_z());
  const Circle one = inscribed_circle(first, pose_a), other = inscribed_circle(second, pose_b);
  const double entered = one.radius + other.radius - (one.middle - other.middle).norm();
  return std::min(common_height, entered) > settings.penetration ||
         collides(first, pose_a, second, pose_b, settings);
}

PreparedScene prepare(const Scene& scene, const Executor& executor, const StopCondition& stop) {
  Observation observation(scene.camera, scene.depth, scene.mask);
  const double table = scene.table_height.value_or(lowest_height(observation));
  const Eigen::AlignedBox2d seen = footprint(observation);
  PreparedScene prepared{std::move(observation), models_of(scene, table, executor, stop), {}, {}, {}};
  for (const ObjectModel& model : prepared.models) {
    const double r = model.radius();
    prepared.workspaces.push_back(scene.workspace.value_or(
        Workspace{seen.min().x() - r, seen.max().x() + r, seen.min().y() - r, seen.max().y() + r}));
  }
  prepared.copies.resize(prepared.models.size(), 0);
  for (const SceneObject& object : scene.objects) {
    ++prepared.copies[object.model];
    prepared.of_object.push_back(object.model);
  }
  return prepared;
}

}  // namespace perch
