#include "perch/baselines/pose_aligner.hpp"

#include "perch/refine/visible_samples.hpp"

namespace perch {
namespace {

constexpr double default_reach = 0.02;  // metres

}  // namespace

PoseAligner::PoseAligner(const PreparedScene& scene, const RefineSettings& settings, const Executor& executor,
                         const StopCondition& stop)
    : scene_(scene),
      settings_(settings),
      reach_(settings.reach.value_or(default_reach)),
      observed_(scene.observation, reach_, executor, stop) {
  const Eigen::Vector3d eye = scene.observation.camera().world_from_camera.translation();
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    const Workspace& w = scene.workspaces[m];
    const Eigen::Vector3d middle(0.5 * (w.x_min + w.x_max), 0.5 * (w.y_min + w.y_max),
                                 scene.models[m].origin_z() + 0.5 * scene.models[m].height());
    views_.emplace_back(scene.models[m], (eye - middle).norm(), settings.samples);
  }
}

Pose PoseAligner::align(std::size_t model, const Pose& start, const DepthPatch* in_front) const {
  const Observation& observation = scene_.observation;
  const Eigen::Vector3d eye = observation.camera().world_from_camera.translation();
  const ObjectModel& object = scene_.models[model];
  Pose pose = scene_.admitted(model, start);
  if (settings_.method == RefineMethod::none) return pose;
  SurfaceSamples samples;
  Sight sight;
  for (int round = 0; round < settings_.rounds; ++round) {
    const SurfaceViews::View view = views_[model].from(eye, pose);
    visible_samples(view.samples, {pose.x, pose.y, view.yaw}, object.origin_z(), in_front, observation,
                    settings_.occlusion, samples, sight);
    const Pose moved = scene_.admitted(
        model,
        perch::align(samples, pose, object.symmetry().is_continuous(), observed_, reach_, settings_).pose);
    if (moved == pose) break;
    pose = moved;
  }
  return pose;
}

}  // namespace perch
