#include "perch/candidates/candidate_maker.hpp"

#include <algorithm>

#include "perch/core/stopwatch.hpp"

namespace perch {
CandidateMaker::CandidateMaker(const LocalizationProblem& problem)
    : problem_(problem), rasterizer_(problem.observation().intrinsics()), lone_cost_(problem.cost()) {}

void CandidateMaker::render(std::size_t model, const Pose& pose, DepthPatch& patch) {
  const ThreadStopwatch watch;
  problem_.render(model, pose, rasterizer_, patch);
  effort_.work.add_rendering(patch.window);
  effort_.seconds.render += watch.seconds();
}

std::optional<Candidate> CandidateMaker::make(std::size_t model, const Pose& grid_pose,
                                              const DepthPatch* in_front) {
  seen_ = {};
  return value(model, problem_.nearest() == nullptr ? grid_pose : refine(model, grid_pose, in_front).pose);
}

std::optional<Candidate> CandidateMaker::value(std::size_t model, const Pose& pose) {
  if (!problem_.admits(model, pose)) return std::nullopt;
  render(model, pose);
  if (!patch_.any()) return std::nullopt;
  return value_rendered(model, pose);
}

std::optional<Placing> CandidateMaker::place(const Composite& others, std::size_t model, const Pose& pose,
                                             bool align, std::int64_t most) {
  const bool refines = problem_.nearest() != nullptr;
  Placing placing{align && refines ? refine(model, pose, &others.depth).pose : pose, {}};
  if (!problem_.admits(model, placing.pose)) return std::nullopt;
  render(model, placing.pose);
  if (!patch_.any()) return std::nullopt;
  const ThreadStopwatch watch;
  const auto counts = lone_cost_.counts_with(others, patch_, most);
  if (counts) placing.counts = *counts;
  if (counts && refines) {
    sample(model, placing.pose, &others.depth);
    placing.residual = mean_residual(samples_, *problem_.nearest(), problem_.settings().cost.delta);
  }
  effort_.seconds.cost += watch.seconds();
  return counts ? std::optional(placing) : std::nullopt;
}

void CandidateMaker::sample(std::size_t model, const Pose& pose, const DepthPatch* in_front) {
  const Observation& observation = problem_.observation();
  const SurfaceViews::View view =
      problem_.views(model).from(observation.camera().world_from_camera.translation(), pose);
  visible_samples(view.samples, {pose.x, pose.y, view.yaw}, problem_.models()[model].origin_z(), in_front,
                  observation, problem_.settings().refine.occlusion, samples_, seen_);
}

Alignment CandidateMaker::refine(std::size_t model, const Pose& grid_pose, const DepthPatch* in_front) {
  const ThreadStopwatch watch;
  const CandidateSettings& settings = problem_.settings();
  const Workspace& workspace = problem_.workspace(model);
  const Symmetry& symmetry = problem_.models()[model].symmetry();
  Alignment refined{grid_pose};
  Pose& pose = refined.pose;
  for (int round = 0; round < settings.refine.rounds; ++round) {
    sample(model, pose, in_front);
    auto [moved, misfit] = align(samples_, pose, symmetry.is_continuous(), *problem_.nearest(),
                                 settings.icp_reach(), settings.refine);
    ++effort_.work.alignments;
    refined.misfit = misfit;
    moved.x = std::clamp(moved.x, workspace.x_min, workspace.x_max);
    moved.y = std::clamp(moved.y, workspace.y_min, workspace.y_max);
    moved.yaw = symmetry.canonical_yaw(moved.yaw);
    if (moved == pose) break;
    pose = moved;
  }
  effort_.seconds.refine += watch.seconds();
  return refined;
}

Candidate CandidateMaker::value_rendered(std::size_t model, const Pose& pose) {
  const ThreadStopwatch watch;
  lone_cost_.value(patch_, lone_value_);
  Candidate candidate;
  candidate.model = model;
  candidate.pose = pose;
  candidate.window = patch_.window;
  candidate.points = lone_value_.points;
  candidate.unexplained = lone_value_.unexplained;
  candidate.exposed = lone_value_.exposed;
  candidate.explained_count = lone_value_.explained_count;
  candidate.explained = PointSet(lone_value_.explained);
  candidate.explained_runs = lone_value_.explained;
  candidate.certain_runs = lone_value_.certain;
  candidate.uncertain_runs = lone_value_.uncertain;
  candidate.explained_pixels = lone_value_.shown;
  if (!candidate.explained_pixels.empty()) candidate.patch = patch_;
  effort_.seconds.cost += watch.seconds();
  return candidate;
}

void CandidateMaker::add_volumes(Candidate& candidate) const {
  if (candidate.absent) return;
  const Observation& observation = problem_.observation();
  const SolidVolume& solid = problem_.models()[candidate.model].solid();
  const Eigen::Isometry3f model_from_camera =
      problem_.camera_from_model(candidate.model, candidate.pose).inverse().cast<float>();
  const float delta = static_cast<float>(problem_.settings().cost.delta);
  const float enclosing = problem_.enclosing_depth(candidate.model);
  PointSet enclosed(observation.size()), reached(observation.size());
  // A point within delta of the solid is seen this near to the solid's image.
  const int margin = problem_.cost().index().reach() + 2;
  const Window& window = candidate.window;
  const int last_row = std::min(observation.intrinsics().height, window.v1 + margin);
  for (int v = std::max(0, window.v0 - margin); v < last_row; ++v)
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i) {
      if (observation.column(i) < window.u0 - margin || observation.column(i) >= window.u1 + margin) continue;
      const Eigen::Vector3f p = model_from_camera * observation.points()[i];
      if (solid.signed_distance(p) < -delta) continue;
      reached.insert(i);
      if (problem_.cost().charges_points() && solid.depth_lower_bound(p) > enclosing) enclosed.insert(i);
    }
  candidate.reached = reached.trimmed();
  candidate.enclosed = enclosed.trimmed();
}

const DepthPatch& CandidateMaker::patch(const Candidate& candidate) {
  if (candidate.absent || !candidate.patch.window.empty()) return candidate.patch;
  const Work before = effort_.work;
  render(candidate.model, candidate.pose);
  if (candidate.drawn_elsewhere) effort_.work = before;
  return patch_;
}

}  // namespace perch
