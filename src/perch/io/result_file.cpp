#include "perch/io/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "perch/core/error.hpp"
#include "perch/io/json_entry.hpp"
#include "perch/io/message.hpp"
#include "perch/localize/settings.hpp"

namespace perch {
namespace {

/// The file's entries as values; holds what they are checked against.
class ResultReader {
 public:
  explicit ResultReader(const Scene& scene) : scene_(scene) {
    for (const SceneModel& model : scene.models) names_.push_back(as_json_holds(model.name));
  }

  ReportedResult read(const JsonEntry& root) const {
    const JsonEntry version = root["version"];
    if (version.integer() != 1)
      version.fail(fmt::format("{} is not a version that can be read; give version 1", version.value()));
    ReportedResult result;
    // Results without this key are perch's own.
    if (root.contains("method")) result.method = method(root["method"]);
    result.status = status(root["status"]);
    result.cost = count_or_null(root["cost"]);
    result.cost_observed = count_or_null(root["cost_observed"]);
    result.cost_rendered = count_or_null(root["cost_rendered"]);
    result.observed_points = root["observed_points"].integer();
    result.search_cost = count_or_null(root["search_cost"]);
    result.lower_bound = root["lower_bound"].integer();
    if (const JsonEntry bound = root["suboptimality_bound"]; !bound.is_null())
      result.suboptimality_bound = bound.number();
    if (result.has_bound())
      result.guarantee = guarantee(root["guarantee"]);
    else
      result.guarantee = without_guarantee(root);
    for (const JsonEntry& entry : records(root["search_objects"]))
      result.search_objects.push_back({body(entry), pose(entry)});
    for (const JsonEntry& entry : records(root["objects"])) result.objects.push_back(object(entry));
    result.stats = stats(root["stats"]);
    return result;
  }

 private:
  static std::string method(const JsonEntry& entry) {
    std::vector<std::string> names;
    for (const auto known : {LocalizationMethod::perch, LocalizationMethod::bfwor,
                             LocalizationMethod::ourcvfh, LocalizationMethod::ppf})
      names.push_back(name(known));
    const std::string word = entry.text();
    if (std::find(names.begin(), names.end(), word) == names.end())
      entry.fail(fmt::format("{} is no method; {}", entry.value(), did_you_mean(word, names)));
    return word;
  }

  static Status status(const JsonEntry& entry) {
    const std::string word = entry.text();
    if (word == "solved") return Status::solved;
    if (word == "time_limit") return Status::time_limit;
    if (word == "infeasible") return Status::infeasible;
    if (word == "unproven") return Status::unproven;
    entry.fail(fmt::format("{} is no status; {}", entry.value(),
                           did_you_mean(word, {"solved", "time_limit", "infeasible", "unproven"})));
  }

  static std::optional<std::int64_t> count_or_null(const JsonEntry& entry) {
    return entry.is_null() ? std::nullopt : std::optional(entry.integer());
  }

  static std::vector<JsonEntry> records(const JsonEntry& entry) {
    constexpr std::size_t most = 1000;  // as in a scene file
    auto items = entry.items();
    if (items.size() > most) entry.fail(fmt::format("has {} entries; give at most {}", items.size(), most));
    return items;
  }

  /// Only where clutter may be in view.
  static std::optional<Guarantee::Clutter> clutter(const JsonEntry& counted) {
    if (!counted.contains("clutter")) return std::nullopt;
    const JsonEntry entry = counted["clutter"];
    return Guarantee::Clutter{entry["weight"].number(), entry["points"].text()};
  }

  static Guarantee without_guarantee(const JsonEntry& root) {
    if (const JsonEntry entry = root["guarantee"]; !entry.is_null())
      entry.fail("is there, but the method has no bound; give null");
    const JsonEntry counted = root["counted_with"];
    Guarantee g;
    g.delta = counted["delta"].number();
    g.missing_depth = counted["missing_depth"].text();
    g.clutter = clutter(counted);
    const CollisionSettings collision;
    g.collision_penetration = collision.penetration;
    g.collision_overlap = collision.overlap;
    return g;
  }

  static Guarantee guarantee(const JsonEntry& entry) {
    Guarantee g;
    g.w = entry["w"].number();
    g.over = entry["over"].text();
    g.delta = entry["delta"].number();
    g.missing_depth = entry["missing_depth"].text();
    g.clutter = clutter(entry);
    const JsonEntry collision = entry["collision"];
    g.collision_penetration = collision["penetration"].number();
    g.collision_overlap = collision["overlap"].number();
    g.resolution_m = entry["resolution_m"].number();
    g.yaw_resolution_rad = entry["yaw_resolution_rad"].number();
    g.candidates = entry["candidates"].integer();
    g.refine = entry["refine"].text();
    g.search = entry["search"].text();
    return g;
  }

  static Pose pose(const JsonEntry& entry) {
    constexpr double farthest = 1e6;  // beyond it, float has no use for pixels
    const auto coordinate = [&](const char* key) {
      const JsonEntry value = entry[key];
      const double metres = value.number();
      if (!(metres >= -farthest && metres <= farthest))
        value.fail(fmt::format("{} m is beyond {} m; give metres", value.value(), farthest));
      return metres;
    };
    return {coordinate("x"), coordinate("y"), entry["yaw"].number()};
  }

  static Eigen::Matrix4d matrix(const JsonEntry& entry) {
    const auto rows = entry.items();
    if (rows.size() != 4) entry.fail(fmt::format("has {} rows; give a 4 x 4 matrix", rows.size()));
    Eigen::Matrix4d matrix;
    for (std::size_t i = 0; i < 4; ++i) {
      const auto values = rows[i].items();
      if (values.size() != 4) rows[i].fail(fmt::format("has {} values; give a 4 x 4 matrix", values.size()));
      for (std::size_t j = 0; j < 4; ++j)
        matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = values[j].number();
    }
    return matrix;
  }

  std::size_t model(const JsonEntry& entry) const {
    const std::string name = entry.text();
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end())
      entry.fail(fmt::format("{} is no model of the scene; {}", entry.value(), did_you_mean(name, names_)));
    return static_cast<std::size_t>(found - names_.begin());
  }

  /// Which of a model's orientations an entry is of, 0 where it doesn't say.
  int rest_pose(const JsonEntry& entry, std::size_t model) const {
    if (!entry.contains("rest_pose")) return 0;
    const JsonEntry value = entry["rest_pose"];
    const std::int64_t index = value.integer();
    const auto poses = static_cast<std::int64_t>(rest_pose_count(scene_.models, model));
    if (index < 0 || index >= poses)
      value.fail(fmt::format("{} is no rest pose of the model; give a number from 0 to {}", value.value(),
                             poses - 1));
    return static_cast<int>(index);
  }

  std::size_t body(const JsonEntry& entry) const {
    const std::size_t first = model(entry["model"]);
    return first + static_cast<std::size_t>(rest_pose(entry, first));
  }

  ReportedObject object(const JsonEntry& entry) const {
    ReportedObject object;
    object.model = body(entry);
    object.absent = entry.contains("absent") && entry["absent"].boolean();
    if (object.absent) return object;
    object.pose = pose(entry);
    object.world_from_model = matrix(entry["world_from_model"]);
    object.camera_from_model = matrix(entry["camera_from_model"]);
    object.visible_pixels = entry["visible_pixels"].integer();
    object.visible_fraction = entry["visible_fraction"].number();
    object.explained_fraction = entry["explained_fraction"].number();
    if (entry.contains("confidence") && !entry["confidence"].is_null())
      object.confidence = entry["confidence"].number();
    if (entry.contains("runner_up") && !entry["runner_up"].is_null()) {
      const JsonEntry other = entry["runner_up"];
      object.runner_up = RunnerUp{pose(other), other["cost_increase"].integer(), std::nullopt};
      if (rest_pose_count(scene_.models, object.model) > 1)
        object.runner_up->rest_pose = rest_pose(other, scene_.kind(object.model));
    }
    return object;
  }

  static Stats stats(const JsonEntry& entry) {
    const auto workers = [&](const char* key) {
      const JsonEntry value = entry[key];
      const std::int64_t number = value.integer();
      if (number < 1 || number > 1'000'000)
        value.fail(fmt::format("{} is not from 1 to 1000000; give a number of workers", value.value()));
      return static_cast<int>(number);
    };
    Stats s;
    s.rendered = entry["rendered"].integer();
    s.generated = entry["generated"].integer();
    s.expanded = entry["expanded"].integer();
    s.threads = workers("threads");
    s.ranks = workers("ranks");
    const JsonEntry seconds = entry["seconds"];
    const auto stage = [&](const char* key) { return seconds.contains(key) ? seconds[key].number() : 0.0; };
    s.seconds = {seconds["total"].number(),
                 seconds["render"].number(),
                 seconds["refine"].number(),
                 seconds["cost"].number(),
                 stage("candidates"),
                 seconds["search"].number(),
                 stage("polish")};
    if (entry.contains("work")) {
      const JsonEntry work = entry["work"];
      s.work = {work["renderings"].integer(), work["alignments"].integer(), work["pixels"].integer()};
    }
    return s;
  }

  const Scene& scene_;
  std::vector<std::string> names_;  ///< of the scene's models, as written
};

}  // namespace

ReportedResult read_result(const std::filesystem::path& path, const Scene& scene) {
  try {
    return ResultReader(scene).read(JsonEntry::read(path));
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(
        fmt::format("{}: there is not enough memory to read it; give a smaller file", shown(path)));
  } catch (const std::exception& e) {
    throw InputError(fmt::format("{}: can't be read ({}); check the file", shown(path), one_line(e.what())));
  }
}

}  // namespace perch
