#include "perch/eval/scene_evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "perch/core/assignment.hpp"
#include "perch/eval/pose_errors.hpp"
#include "perch/eval/visible_fractions.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

double translation_error(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

/// Farther than this a pair is no better than any other; a half turn counts as much as the second.
constexpr double farthest_pair = 0.1, half_turn = 0.01;

}  // namespace

SceneEvaluator::SceneEvaluator(const Scene& scene, std::string name, double table_height,
                               std::optional<std::vector<double>> visible)
    : scene_(scene), table_height_(table_height), slopes_(scene.camera.intrinsics) {
  Rasterizer rasterizer(scene.camera.intrinsics);
  std::map<std::size_t, double> diameters;
  for (const TruthPose& truth : scene.truth) {
    const Mesh& mesh = scene.models[truth.model].mesh;
    true_patches_.push_back(rasterizer.render(mesh, camera_from_model(truth.model, truth.pose)));
    if (!diameters.contains(truth.model)) diameters[truth.model] = diameter(mesh.vertices);
  }
  const std::vector<double> fractions = visible ? *std::move(visible) : visible_fractions(true_patches_);
  record_.scene = std::move(name);
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    const TruthPose& truth = scene.truth[i];
    ObjectRecord& object = record_.objects.emplace_back();
    object.model = scene.models[truth.model].name;
    object.visible_fraction = fractions.at(i);
    object.diameter = diameters.at(truth.model);
    object.symmetric = truth.symmetry != Symmetry::none();
  }
}

Eigen::Isometry3d SceneEvaluator::camera_from_model(std::size_t model, const Pose& pose) const {
  return scene_.camera.world_from_camera.inverse() *
         world_from_model(pose, table_height_ + scene_.models[model].base);
}

std::vector<std::optional<std::size_t>> SceneEvaluator::assigned(const ReportedResult& result) const {
  std::vector<std::optional<std::size_t>> found_for(scene_.truth.size());
  for (std::size_t kind = 0; kind < scene_.models.size(); ++kind) {
    std::vector<std::size_t> truths, found;
    for (std::size_t i = 0; i < scene_.truth.size(); ++i)
      if (scene_.kind(scene_.truth[i].model) == kind) truths.push_back(i);
    for (std::size_t i = 0; i < result.objects.size(); ++i)
      if (!result.objects[i].absent && scene_.kind(result.objects[i].model) == kind) found.push_back(i);
    Eigen::MatrixXd costs(truths.size(), found.size());
    for (std::size_t t = 0; t < truths.size(); ++t)
      for (std::size_t f = 0; f < found.size(); ++f) {
        const TruthPose& truth = scene_.truth[truths[t]];
        const ReportedObject& object = result.objects[found[f]];
        const Pose& pose = object.pose;
        const double turn = object.model == truth.model
                                ? truth.symmetry.yaw_difference(truth.pose.yaw, pose.yaw)
                                : std::numbers::pi;
        costs(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(f)) =
            std::min(farthest_pair, translation_error(truth.pose, pose)) +
            half_turn * turn / std::numbers::pi;
      }
    const auto column_of = min_cost_assignment(costs);
    for (std::size_t t = 0; t < truths.size(); ++t)
      if (column_of[t]) found_for[truths[t]] = found[*column_of[t]];
  }
  return found_for;
}

PoseErrors SceneEvaluator::errors(std::size_t object, const PlacedModel& estimate) const {
  const TruthPose& truth = scene_.truth[object];
  const Intrinsics& intrinsics = scene_.camera.intrinsics;
  const Mesh& mesh = scene_.models[truth.model].mesh;
  // In the frame in which the model truly stands, which is its own but for a fixed motion.
  Eigen::Isometry3d estimated = camera_from_model(estimate.model, estimate.pose);
  if (estimate.model != truth.model)
    estimated = estimated * scene_.models[estimate.model].stood_from_model *
                scene_.models[truth.model].stood_from_model.inverse();
  const Eigen::Isometry3d true_pose = camera_from_model(truth.model, truth.pose);
  const auto symmetries = symmetry_turns(truth.symmetry);
  PoseErrors errors;
  errors.translation = translation_error(truth.pose, estimate.pose);
  errors.other_rest_pose = estimate.model != truth.model;
  errors.yaw = errors.other_rest_pose ? std::numbers::pi
                                      : truth.symmetry.yaw_difference(truth.pose.yaw, estimate.pose.yaw);
  errors.add = average_distance(mesh.vertices, estimated, true_pose);
  errors.add_s = average_nearest_distance(mesh.vertices, estimated, true_pose);
  errors.mssd = largest_surface_distance(mesh.vertices, estimated, true_pose, symmetries);
  errors.mspd = largest_projection_distance(mesh.vertices, estimated, true_pose, symmetries, intrinsics) *
                640.0 / intrinsics.width;
  errors.vsd = surface_discrepancy(Rasterizer(intrinsics).render(mesh, estimated), true_patches_[object],
                                   scene_.depth, slopes_, record_.objects[object].diameter);
  return errors;
}

void SceneEvaluator::compare_costs(const std::vector<std::optional<PlacedModel>>& estimates,
                                   const CostOf& cost_of, SceneRecord& record) const {
  std::vector<PlacedModel> truth;
  for (const TruthPose& object : scene_.truth) truth.push_back({object.model, object.pose});
  std::vector<std::vector<PlacedModel>> arrangements{truth};
  std::vector<std::size_t> compared;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (!estimates[i] || tightest_threshold.holds(*record.objects[i].errors)) continue;
    compared.push_back(i);
    arrangements.push_back(truth);
    arrangements.back()[i] = *estimates[i];
  }
  if (compared.empty()) return;
  const std::vector<std::int64_t> costs = cost_of(arrangements);
  for (std::size_t i = 0; i < compared.size(); ++i)
    record.objects[compared[i]].costs = CostComparison{costs.at(0), costs.at(i + 1)};
}

SceneRecord SceneEvaluator::evaluate(const ReportedResult& result, const CostOf& cost_of) const {
  SceneRecord record = record_;
  record.run = RunRecord{result.status, result.stats.seconds.total, result.stats.rendered,
                         result.stats.expanded, result.suboptimality_bound};
  const auto found_for = assigned(result);
  std::vector<std::optional<PlacedModel>> estimates(found_for.size());
  record.surplus = static_cast<std::size_t>(std::count_if(result.objects.begin(), result.objects.end(),
                                                          [](const ReportedObject& o) { return !o.absent; }));
  for (std::size_t i = 0; i < found_for.size(); ++i) {
    if (!found_for[i]) continue;
    const ReportedObject& found = result.objects[*found_for[i]];
    estimates[i] = PlacedModel{found.model, found.pose};
    record.objects[i].errors = errors(i, *estimates[i]);
    record.objects[i].confidence = found.confidence;
    --record.surplus;
  }
  if (cost_of) compare_costs(estimates, cost_of, record);
  return record;
}

}  // namespace perch
