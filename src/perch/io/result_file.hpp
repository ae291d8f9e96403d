#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// One record of `objects` as a result.json states it.
struct ReportedObject {
  std::size_t model = 0;  ///< counts into Scene::models: the body, the first of its model where absent
  bool absent = false;    ///< no pose is stated: nothing below holds
  Pose pose;
  Eigen::Matrix4d world_from_model = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d camera_from_model = Eigen::Matrix4d::Identity();
  std::int64_t visible_pixels = 0;
  double visible_fraction = 0.0;
  double explained_fraction = 0.0;
  std::optional<double> confidence;   ///< empty where null or not there
  std::optional<RunnerUp> runner_up;  ///< the same
};

/// What a result.json states, right or wrong: nothing is derived and nothing put straight.
struct ReportedResult {
  std::string method = "perch";  ///< as `--method` names it; so where the file has no such key
  Status status = Status::infeasible;
  std::optional<std::int64_t> cost, cost_observed, cost_rendered;
  std::int64_t observed_points = 0;
  std::optional<std::int64_t> search_cost;
  std::int64_t lower_bound = 0;
  std::optional<double> suboptimality_bound;
  Guarantee guarantee;  ///< where it is null: delta and missing_depth as in `counted_with`, collisions as by
                        ///< default, all else unset
  /// False for the baselines: there is neither a searched scene nor a bound.
  bool has_bound() const { return method == "perch"; }
  /// Of the plane that was found in the depth image, where there was one to be found.
  std::optional<Eigen::Matrix4d> world_from_camera;
  std::optional<double> table_height;
  std::vector<PlacedModel> search_objects;
  std::vector<ReportedObject> objects;
  Stats stats;
};

/// Reads a result.json of the scene. Keys that are not known are skipped. Throws InputError, one line
/// `<file>: <key>: <value and what is wrong>; <remedy>`, for anything that is no JSON, repeats a key, lacks
/// one, holds another type than it should (a count that is not whole) or a model that the scene doesn't have;
/// and nothing else. Whether the values are true is not its business.
ReportedResult read_result(const std::filesystem::path& path, const Scene& scene);

}  // namespace perch
