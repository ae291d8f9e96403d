#include "perch/io/result_json.hpp"

#include <nlohmann/json.hpp>

namespace perch {
namespace {

using OrderedJson = nlohmann::ordered_json;

template <typename T>
OrderedJson or_null(const std::optional<T>& value) {
  return value ? OrderedJson(*value) : OrderedJson(nullptr);
}

OrderedJson matrix(const Eigen::Isometry3d& transform) {
  OrderedJson rows = OrderedJson::array();
  for (int i = 0; i < 4; ++i) {
    OrderedJson row = OrderedJson::array();
    for (int j = 0; j < 4; ++j) row.push_back(transform.matrix()(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Where an object stands; how it rests only of a model that may rest in several ways.
OrderedJson pose_value(const Pose& pose, const std::optional<int>& rest_pose) {
  OrderedJson json{{"x", pose.x}, {"y", pose.y}, {"yaw", pose.yaw}};
  if (rest_pose) json["rest_pose"] = *rest_pose;
  return json;
}

OrderedJson to_value(const RunnerUp& r) {
  OrderedJson json = pose_value(r.pose, r.rest_pose);
  json["cost_increase"] = r.cost_increase;
  return json;
}

OrderedJson to_value(const ObjectResult& o) {
  if (o.absent) return {{"model", o.model}, {"absent", true}};
  OrderedJson json{{"model", o.model}};
  json.update(pose_value(o.pose, o.rest_pose));
  json.update(OrderedJson{{"world_from_model", matrix(o.world_from_model)},
                          {"camera_from_model", matrix(o.camera_from_model)},
                          {"visible_pixels", o.visible_pixels},
                          {"visible_fraction", o.visible_fraction},
                          {"explained_fraction", o.explained_fraction},
                          {"confidence", or_null(o.confidence)},
                          {"runner_up", o.runner_up ? to_value(*o.runner_up) : OrderedJson(nullptr)}});
  return json;
}

OrderedJson to_value(const ResultPose& p) {
  OrderedJson json{{"model", p.model}};
  json.update(pose_value(p.pose, p.rest_pose));
  return json;
}

/// What the costs of a result without a guarantee are counted with.
OrderedJson counted_with(const Guarantee& g) {
  OrderedJson counted{{"delta", g.delta}, {"missing_depth", g.missing_depth}};
  if (g.clutter) counted["clutter"] = {{"weight", g.clutter->weight}, {"points", g.clutter->points}};
  return counted;
}

OrderedJson to_value(const Guarantee& g) {
  OrderedJson value{{"w", g.w}, {"over", g.over}};
  value.update(counted_with(g));
  value.update(
      OrderedJson{{"collision", {{"penetration", g.collision_penetration}, {"overlap", g.collision_overlap}}},
                  {"resolution_m", g.resolution_m},
                  {"yaw_resolution_rad", g.yaw_resolution_rad},
                  {"candidates", g.candidates},
                  {"refine", g.refine},
                  {"search", g.search}});
  return value;
}

OrderedJson to_value(const Stats& s) {
  return {{"rendered", s.rendered},
          {"generated", s.generated},
          {"expanded", s.expanded},
          {"threads", s.threads},
          {"ranks", s.ranks},
          {"work",
           {{"renderings", s.work.renderings}, {"alignments", s.work.alignments}, {"pixels", s.work.pixels}}},
          {"seconds",
           {{"total", s.seconds.total},
            {"render", s.seconds.render},
            {"refine", s.seconds.refine},
            {"cost", s.seconds.cost},
            {"candidates", s.seconds.candidates},
            {"search", s.seconds.search},
            {"polish", s.seconds.polish}}}};
}

OrderedJson to_value(const ReportedSupport& s) {
  return {{"world_from_camera", matrix(s.world_from_camera)},
          {"camera_estimated", s.camera_estimated},
          {"table_height", s.table_height},
          {"height_estimated", s.height_estimated},
          {"rms", s.rms}};
}

OrderedJson to_value(const ScoreRecord& r) {
  return {{"cost", r.cost.cost},
          {"cost_observed", r.cost.cost_observed},
          {"cost_rendered", r.cost.cost_rendered},
          {"rendered_points", r.rendered_points},
          {"observed_points", r.observed_points},
          {"monotone", r.monotone},
          {"collides", r.collides}};
}

template <typename T>
OrderedJson list(const std::vector<T>& values) {
  OrderedJson out = OrderedJson::array();
  for (const T& value : values) out.push_back(to_value(value));
  return out;
}

/// Indented text. Names come from files and may hold bytes that are not UTF-8, which JSON can't.
std::string dump(const OrderedJson& json) {
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace

std::string to_json(const Result& result) {
  const auto part = [&](std::int64_t CostRecord::*member) {
    return result.cost ? OrderedJson((*result.cost).*member) : OrderedJson(nullptr);
  };
  OrderedJson json{{"version", 1},
                   {"method", result.method},
                   {"status", name(result.status)},
                   {"reason", result.reason},
                   {"cost", part(&CostRecord::cost)},
                   {"cost_observed", part(&CostRecord::cost_observed)},
                   {"cost_rendered", part(&CostRecord::cost_rendered)},
                   {"observed_points", result.observed_points},
                   {"search_cost", or_null(result.search_cost)},
                   {"lower_bound", result.lower_bound},
                   {"suboptimality_bound", or_null(result.suboptimality_bound())},
                   {"guarantee", result.has_bound() ? to_value(result.guarantee) : OrderedJson(nullptr)},
                   {"search_objects", list(result.search_objects)},
                   {"objects", list(result.objects)},
                   {"stats", to_value(result.stats)}};
  if (result.support) json["support_plane"] = to_value(*result.support);
  if (!result.has_bound()) json["counted_with"] = counted_with(result.guarantee);
  return dump(json);
}

std::string to_json_lines(const std::vector<TraceEntry>& trace) {
  std::string lines;
  for (const TraceEntry& entry : trace)
    lines += OrderedJson{{"seconds", entry.seconds},
                         {"cost", or_null(entry.cost)},
                         {"search_cost", or_null(entry.search_cost)},
                         {"lower_bound", entry.lower_bound},
                         {"expanded", entry.expanded}}
                 .dump() +
             "\n";
  return lines;
}

std::string to_json(const std::vector<ScoreRecord>& records) {
  return dump(list(records));
}

}  // namespace perch
