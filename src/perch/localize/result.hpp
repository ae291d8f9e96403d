#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "perch/candidates/work.hpp"
#include "perch/core/pose.hpp"

namespace perch {

enum class Status {
  solved,
  time_limit,
  infeasible,
  unproven  ///< the answer of a method that proves nothing
};

/// As result.json writes it.
constexpr std::string_view name(Status status) {
  switch (status) {
    case Status::solved:
      return "solved";
    case Status::time_limit:
      return "time_limit";
    case Status::infeasible:
      return "infeasible";
    case Status::unproven:
      break;
  }
  return "unproven";
}

/// The flat explanation cost of a scene and its parts, counts of points.
struct CostRecord {
  std::int64_t cost = 0;
  std::int64_t cost_observed = 0;
  std::int64_t cost_rendered = 0;
};

struct ResultPose {
  std::string model;
  Pose pose;
  std::optional<int> rest_pose = std::nullopt;  ///< which of the model's orientations; empty where it has one
};

/// The next best pose of an object, all others as they are.
struct RunnerUp {
  Pose pose;
  std::int64_t cost_increase = 0;               ///< of J
  std::optional<int> rest_pose = std::nullopt;  ///< as ResultPose::rest_pose
};

/// One object of the scene as reported.
struct ObjectResult {
  std::string model;
  bool absent = false;  ///< an optional object that was left out, or one that a baseline found no pose of:
                        ///< nothing below holds
  Pose pose;
  std::optional<int> rest_pose = std::nullopt;  ///< as ResultPose::rest_pose
  /// Of the model's own frame, not turned to how it rests.
  Eigen::Isometry3d world_from_model = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  std::int64_t visible_pixels = 0;  ///< pixels at which this object is the nearest of the scene
  double visible_fraction = 0.0;    ///< of the pixels that it would cover alone
  double explained_fraction =
      0.0;  ///< of its visible rendered points, those within delta of an observed point
  std::optional<double> confidence;   ///< in [0, 1], see docs/confidence.md; empty where not judged
  std::optional<RunnerUp> runner_up;  ///< empty where there is none, or not judged
};

/// What the bound ranges over.
struct Guarantee {
  double w = 3.0;
  std::string over;
  double delta = 0.0;         ///< of the costs, metres
  std::string missing_depth;  ///< how they count rendered points without a reading
  /// Where clutter may be in view: CostSettings::clutter_weight and clutter_points.
  struct Clutter {
    double weight = 0.0;
    std::string points;
  };
  std::optional<Clutter> clutter;
  double collision_penetration = 0.0;  ///< how far objects of the set may enter each other, metres
  double collision_overlap = 0.0;      ///< share of a solid of theirs that may lie inside another
  double resolution_m = 0.0;
  double yaw_resolution_rad = 0.0;
  std::int64_t candidates = 0;
  std::string refine;
  std::string search;
};

/// Of wall clock for the whole and its parts one after the other, `candidates`, `search` and `polish`; summed
/// over threads for `render`, `refine` and `cost`, which are within these.
struct Seconds {
  double total = 0.0, render = 0.0, refine = 0.0, cost = 0.0, candidates = 0.0, search = 0.0, polish = 0.0;
};

struct Stats {
  std::int64_t rendered = 0;  ///< hypotheses valued: distinct (model, grid pose, parent) triples
  std::int64_t generated = 0;
  std::int64_t expanded = 0;
  int threads = 1;
  int ranks = 1;
  Seconds seconds;
  Work work;                    ///< up to the report, whose own renderings are left out
  std::int64_t made_again = 0;  ///< of the hypotheses in context, since another rank keeps them; not written
};

/// How good the answer was at some time: written when the scene or its bound got better.
struct TraceEntry {
  double seconds = 0.0;
  std::optional<std::int64_t> cost, search_cost;  ///< of the best scene known
  std::int64_t lower_bound = 0;
  std::uint64_t expanded = 0;  ///< states or nodes so far
};

/// Where camera and table are by a depth image in which the support plane was looked for.
struct ReportedSupport {
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  double table_height = 0.0;      ///< world, metres
  bool camera_estimated = false;  ///< else as given
  bool height_estimated = false;
  double rms = 0.0;  ///< of the plane's readings, metres
};

/// The answer to one scene, as written to result.json.
struct Result {
  std::string method = "perch";  ///< as `--method` names it
  Status status = Status::infeasible;
  std::string reason;  ///< one clause: why it stopped where it did, e.g. which object has no valid pose
  std::optional<CostRecord> cost;  ///< of `objects`; empty without a scene
  std::int64_t observed_points = 0;
  std::optional<std::int64_t> search_cost;  ///< of `search_objects`
  std::int64_t lower_bound = 0;
  Guarantee guarantee;  ///< without has_bound(): what costs are counted with, all else unset
  std::optional<ReportedSupport> support;
  std::vector<ResultPose> search_objects;
  std::vector<ObjectResult> objects;
  Stats stats;
  std::vector<TraceEntry> trace;  ///< ascending in time; costs never rise, bounds never fall

  /// False for the baselines: there is neither a searched scene nor a bound.
  bool has_bound() const { return method == "perch"; }
  /// search_cost / lower_bound; 1 for 0 / 0; empty where the bound is 0 and the cost is not, or without a
  /// scene.
  std::optional<double> suboptimality_bound() const;
};

/// What `score` says of one given scene.
struct ScoreRecord {
  CostRecord cost;
  std::int64_t rendered_points = 0;
  std::int64_t observed_points = 0;
  bool monotone = false;
  bool collides = false;
};

}  // namespace perch
