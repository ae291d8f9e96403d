#include "perch/candidates/problem.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "perch/core/error.hpp"
#include "perch/observation/extent.hpp"

namespace perch {

void CandidateSettings::check() const {
  grid.check();
  cost.check();
  refine.check();
  collision.check();
}

LocalizationProblem::LocalizationProblem(Observation observation, std::vector<ObjectModel> models,
                                         std::vector<std::size_t> objects, std::vector<char> optional,
                                         const std::optional<Workspace>& workspace,
                                         const CandidateSettings& settings, const Executor& executor,
                                         const StopCondition& stop, std::vector<std::size_t> kind_of)
    : settings_((settings.check(), settings)),
      observation_(std::move(observation)),
      index_(observation_, settings.cost.delta, executor, stop),
      cost_(observation_, index_, settings.cost),
      blocks_(observation_, ExplainedBound::block_radius(settings.cost.delta)),
      explained_bound_(observation_.intrinsics(), blocks_, settings.cost.delta, index_.reach()),
      models_(std::move(models)),
      kind_of_(std::move(kind_of)),
      objects_(std::move(objects)),
      optional_(std::move(optional)),
      camera_from_world_(observation_.camera().world_from_camera.inverse()) {
  if (kind_of_.empty()) {
    kind_of_.resize(models_.size());
    std::iota(kind_of_.begin(), kind_of_.end(), std::size_t{0});
  }
  for (std::size_t m = 0; m < models_.size(); ++m) {
    if (kind_of_[m] == bodies_.size()) bodies_.emplace_back();
    bodies_[kind_of_[m]].push_back(m);
  }
  copies_.resize(kinds(), 0);
  for (const std::size_t kind : objects_) ++copies_[kind];
  optional_.resize(kinds(), 0);

  const Eigen::AlignedBox2d seen = footprint(observation_);
  double poses = 0.0;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    const double r = models_[m].radius();
    workspaces_.push_back(workspace.value_or(
        Workspace{seen.min().x() - r, seen.max().x() + r, seen.min().y() - r, seen.max().y() + r}));
    grids_.emplace_back(workspaces_.back(), settings_.grid, models_[m].symmetry());
    if (copies_[kind_of_[m]] > 0) poses += grids_.back().size();
  }
  if (poses > static_cast<double>(settings_.grid.max_poses))
    throw InputError(
        fmt::format("the grid has {} poses, more than memory allows ({}, grid.max_poses); use larger "
                    "--resolution (now {} m) or "
                    "--yaw-resolution-deg, or a smaller workspace",
                    poses < 1e15 ? fmt::format("{:.0f}", poses) : fmt::format("{:.3g}", poses),
                    settings_.grid.max_poses, settings_.grid.resolution));

  if (settings_.refine.method == RefineMethod::icp) {
    nearest_.emplace(observation_, settings_.icp_reach(), executor, stop);
    const Eigen::Vector3d eye = observation_.camera().world_from_camera.translation();
    for (std::size_t m = 0; m < models_.size(); ++m) {
      const Workspace& w = workspaces_[m];
      const Eigen::Vector3d middle(0.5 * (w.x_min + w.x_max), 0.5 * (w.y_min + w.y_max),
                                   models_[m].origin_z() + 0.5 * models_[m].height());
      views_.emplace_back(models_[m], (eye - middle).norm(), settings_.refine.samples);
    }
  }

  float sample_radius = 0.0F;
  for (const ObjectModel& model : models_)
    sample_radius = std::max(sample_radius, model.solid().sample_radius());
  constexpr float rounding = 1e-4F;  // rendered points lie on the surface up to this
  for (const ObjectModel& model : models_)
    enclosing_depth_.push_back(static_cast<float>(settings_.cost.delta + settings_.collision.penetration) +
                               sample_radius + model.solid().uncertainty() + rounding);
}

bool LocalizationProblem::admits(std::size_t model, const Pose& pose) const {
  if (cost_.charges_points()) return true;
  const Eigen::Vector3d middle =
      camera_from_model(model, pose) * models_[model].bounds().center().cast<double>();
  const Intrinsics& k = observation_.intrinsics();
  const double u = k.fx * middle.x() / middle.z() + k.cx, v = k.fy * middle.y() / middle.z() + k.cy;
  return middle.z() > 0.0 && u >= 0.0 && u <= k.width - 1.0 && v >= 0.0 && v <= k.height - 1.0;
}

void LocalizationProblem::render(std::size_t model, const Pose& pose, Rasterizer& rasterizer,
                                 DepthPatch& patch) const {
  rasterizer.render(models_[model].mesh(), camera_from_model(model, pose), patch);
}

bool LocalizationProblem::collide(std::size_t model_a, const Pose& pose_a, std::size_t model_b,
                                  const Pose& pose_b) const {
  return collides(models_[model_a], pose_a, models_[model_b], pose_b, settings_.collision);
}

}  // namespace perch
