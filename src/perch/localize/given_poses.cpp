#include "perch/localize/given_poses.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "perch/localize/report.hpp"
#include "perch/localize/setup.hpp"

namespace perch {
namespace {

std::string reason_for(const Scene& scene, const std::vector<std::optional<Pose>>& poses, bool stopped,
                       const std::string& method) {
  std::vector<std::string> without;
  for (std::size_t i = 0; i < poses.size(); ++i)
    if (!poses[i]) without.push_back(scene.models[scene.objects[i].model].name);
  const std::string ends = stopped ? "the time limit came before " + method + " was done"
                                   : method + " gives poses without a bound";
  return without.empty() ? ends : fmt::format("{}; it found no pose of {}", ends, fmt::join(without, ", "));
}

}  // namespace

Result report_given_poses(const Scene& scene, const std::vector<std::optional<Pose>>& poses, bool stopped,
                          const Settings& settings, const Executor& executor) {
  Result result;
  result.method = name(settings.localization);
  result.status = stopped ? Status::time_limit : Status::unproven;
  result.reason = reason_for(scene, poses, stopped, result.method);
  result.guarantee.delta = settings.candidates.cost.delta;
  result.guarantee.missing_depth = name(settings.candidates.cost.missing_depth);
  result.guarantee.clutter = clutter_of(scene, settings);
  result.stats.threads = static_cast<int>(executor.workers());
  const bool any = std::any_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); });
  if (stopped && !any) {
    result.observed_points =
        static_cast<std::int64_t>(Observation(scene.camera, scene.depth, scene.mask).size());
    return result;
  }
  const auto problem = make_problem(scene, settings, executor);
  result.observed_points = static_cast<std::int64_t>(problem->observation().size());
  std::vector<PlacedModel> placed;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i]) continue;
    const std::size_t model = problem->bodies_of(problem->objects()[i]).front();
    Pose pose = *poses[i];
    pose.yaw = problem->models()[model].symmetry().canonical_yaw(pose.yaw);
    placed.push_back({model, pose});
  }
  report_scene(*problem, placed, result);
  result.trace.push_back({0.0, result.cost->cost, std::nullopt, 0, 0});
  return result;
}

}  // namespace perch
