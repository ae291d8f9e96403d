#include "perch/baselines/bfwor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "perch/baselines/greedy_orders.hpp"
#include "perch/baselines/model_cloud.hpp"
#include "perch/baselines/nearest_point.hpp"
#include "perch/baselines/prepared_scene.hpp"
#include "perch/core/error.hpp"

namespace perch {
namespace {

/// A pose after ICP, and the mean squared distance of the model's points from I, square metres.
struct FittedPose {
  Pose pose;
  double misfit = 0.0;
};

std::vector<Eigen::Vector3f> world_points(const Observation& observation) {
  const Eigen::Isometry3f world_from_camera = observation.camera().world_from_camera.cast<float>();
  std::vector<Eigen::Vector3f> points;
  points.reserve(observation.size());
  for (const Eigen::Vector3f& p : observation.points()) points.push_back(world_from_camera * p);
  return points;
}

class SlidingModels {
 public:
  SlidingModels(const PreparedScene& scene, const BfworSettings& settings, const Executor& executor,
                const StopCondition& stop)
      : scene_(scene),
        settings_(settings),
        executor_(executor),
        stop_(stop),
        reach_(settings.refine.reach.value_or(
            std::min(0.5 * settings.grid.resolution, RefineSettings::largest_reach))),
        table_(scene.observation, reach_, executor, stop),
        observed_(world_points(scene.observation)) {}

  /// Of each model its poses, the best first; less where the clock strikes.
  std::vector<std::vector<FittedPose>> slide() {
    std::vector<std::vector<FittedPose>> all(scene_.models.size());
    for (std::size_t model = 0; model < all.size(); ++model)
      if (scene_.copies[model] > 0) all[model] = slide(model);
    return all;
  }
  std::int64_t hypotheses() const { return hypotheses_; }
  bool stopped() const { return stopped_; }

 private:
  std::vector<FittedPose> slide(std::size_t model) {
    const PoseGrid grid(scene_.workspaces[model], settings_.grid, scene_.models[model].symmetry());
    const SurfaceSamples cloud =
        model_cloud(scene_.models[model].mesh(), static_cast<std::size_t>(settings_.samples));
    std::vector<std::optional<FittedPose>> fitted(static_cast<std::size_t>(grid.size()));
    constexpr std::size_t batch = 16;
    stopped_ |= !for_each_batched(executor_, fitted.size(), batch, stop_, [&](std::size_t i, std::size_t) {
      fitted[i] = fit(model, cloud, grid.pose(static_cast<std::int64_t>(i)));
    });
    std::vector<FittedPose> poses;
    for (const auto& pose : fitted)
      if (pose) poses.push_back(*pose);
    hypotheses_ += static_cast<std::int64_t>(poses.size());
    std::stable_sort(poses.begin(), poses.end(),
                     [](const FittedPose& a, const FittedPose& b) { return a.misfit < b.misfit; });
    return poses;
  }

  FittedPose fit(std::size_t model, const SurfaceSamples& cloud, const Pose& start) const {
    const ObjectModel& object = scene_.models[model];
    FittedPose fitted{start};
    if (settings_.refine.method == RefineMethod::icp)
      fitted.pose =
          scene_.admitted(model, align(placed(cloud, start, object.origin_z()), start,
                                       object.symmetry().is_continuous(), table_, reach_, settings_.refine)
                                     .pose);
    const SurfaceSamples there = placed(cloud, fitted.pose, object.origin_z());
    const float most =
        static_cast<float>(settings_.distance_limit.value_or(std::numeric_limits<double>::infinity()));
    for (std::size_t i = 0; i < there.size(); ++i)
      fitted.misfit += static_cast<double>(std::min(most * most, observed_.squared_distance(there.point(i))));
    fitted.misfit /= static_cast<double>(std::max<std::size_t>(1, there.size()));
    return fitted;
  }

  const PreparedScene& scene_;
  const BfworSettings& settings_;
  const Executor& executor_;
  const StopCondition& stop_;
  double reach_;
  NearestTable table_;
  NearestPoint observed_;
  std::int64_t hypotheses_ = 0;
  bool stopped_ = false;
};

/// As a whole number, so that sums don't depend on the order.
std::int64_t square_micrometres(double square_metres) {
  constexpr double most = 1e15;  // a thousand times a thousand of these can be added
  return std::llround(std::min(most, 1e12 * square_metres));
}

void check_size(const PreparedScene& scene, const GridSettings& settings) {
  double poses = 0.0;
  for (std::size_t model = 0; model < scene.models.size(); ++model)
    if (scene.copies[model] > 0)
      poses += PoseGrid(scene.workspaces[model], settings, scene.models[model].symmetry()).size();
  if (poses > static_cast<double>(settings.max_poses))
    throw InputError(
        fmt::format("the grid has {:.3g} poses, more than memory allows ({}, grid.max_poses); use larger "
                    "--resolution (now "
                    "{} m) or --yaw-resolution-deg, or a smaller workspace",
                    poses, settings.max_poses, settings.resolution));
}

}  // namespace

void BfworSettings::check() const {
  grid.check();
  refine.check();
  collision.check();
  if (samples < 1 || samples > 1'000'000)
    throw InvalidSetting(fmt::format("bfwor.samples is {}; it must lie between 1 and 1000000", samples));
  if (distance_limit && !(*distance_limit > 0.0 && *distance_limit <= 100.0))
    throw InvalidSetting(
        fmt::format("bfwor.distance_limit is {}; it must lie above 0 and up to 100 metres", *distance_limit));
}

BaselineAnswer bfwor(const Scene& scene, const BfworSettings& settings, const Executor& executor,
                     const StopCondition& stop) {
  settings.check();
  const PreparedScene prepared = prepare(scene, executor, stop);
  check_size(prepared, settings.grid);
  SlidingModels sliding(prepared, settings, executor, stop);
  const std::vector<std::vector<FittedPose>> poses = sliding.slide();

  GreedyPlacing placing;
  placing.objects = prepared.of_object;
  for (const auto& of_model : poses) {
    auto& misfits = placing.misfits.emplace_back();
    for (const FittedPose& pose : of_model) misfits.push_back(square_micrometres(pose.misfit));
  }
  placing.collide = [&](std::size_t a, std::size_t i, std::size_t b, std::size_t j) {
    return prepared.collide(a, poses[a][i].pose, b, poses[b][j].pose, settings.collision);
  };
  const BestOrder best = best_order(placing, stop);
  BaselineAnswer answer;
  for (std::size_t i = 0; i < best.poses.size(); ++i)
    answer.poses.push_back(best.poses[i] ? std::optional(poses[prepared.of_object[i]][*best.poses[i]].pose)
                                         : std::nullopt);
  answer.hypotheses = sliding.hypotheses();
  answer.stopped = sliding.stopped() || !best.complete;
  return answer;
}

}  // namespace perch
