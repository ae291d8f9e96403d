#include <cmath>
#include <nlohmann/json.hpp>

#include "perch/eval/tables.hpp"

namespace perch {
namespace {

using Json = nlohmann::ordered_json;

template <typename Value>
Json or_null(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// JSON knows no infinity.
Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json errors_json(const PoseErrors& e) {
  Json json{{"translation", e.translation},
            {"yaw", e.yaw},
            {"add", e.add},
            {"add_s", e.add_s},
            {"mssd", e.mssd},
            {"mspd_px", finite_or_null(e.mspd)},
            {"vsd", e.vsd}};
  if (e.other_rest_pose) json["other_rest_pose"] = true;
  return json;
}

Json object_json(const ObjectRecord& object) {
  Json json{{"model", object.model},
            {"visible_fraction", object.visible_fraction},
            {"diameter", object.diameter},
            {"symmetric", object.symmetric},
            {"verdict", name(object.verdict(right_threshold))},
            {"confidence", or_null(object.confidence)}};
  json["errors"] = object.errors ? errors_json(*object.errors) : Json(nullptr);
  json["costs"] = object.costs
                      ? Json{{"of_truth", object.costs->of_truth}, {"of_estimate", object.costs->of_estimate}}
                      : Json(nullptr);
  return json;
}

Json scene_json(const SceneRecord& scene) {
  Json json{{"scene", scene.scene}};
  json["run"] = nullptr;
  if (const auto& run = scene.run)
    json["run"] = {{"status", name(run->status)},
                   {"seconds", run->seconds},
                   {"rendered", run->rendered},
                   {"expanded", run->expanded},
                   {"suboptimality_bound", or_null(run->suboptimality_bound)}};
  json["surplus"] = scene.surplus;
  json["objects"] = Json::array();
  for (const ObjectRecord& object : scene.objects) json["objects"].push_back(object_json(object));
  return json;
}

Json tally_json(const Tally& tally) {
  return {{"objects", tally.objects},
          {"within", tally.within},
          {"ambiguous", tally.ambiguous},
          {"missed", tally.missed()}};
}

Json summary_json(const MethodSummary& summary) {
  Json json{{"method", summary.method},
            {"scenes", summary.scenes},
            {"without_result", summary.without_result},
            {"objects", summary.right.objects},
            {"not_found", summary.not_found},
            {"surplus", summary.surplus}};
  json["right"] = tally_json(summary.right);
  json["right"]["translation"] = right_threshold.translation;
  json["right"]["yaw"] = right_threshold.yaw;
  json["thresholds"] = Json::array();
  for (std::size_t t = 0; t < paper_translations.size(); ++t)
    for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y) {
      Json entry{{"translation", paper_translations[t]}, {"yaw_deg", paper_yaws_deg[y]}};
      entry.update(tally_json(summary.thresholds[t][y]));
      json["thresholds"].push_back(entry);
    }
  const Recalls& r = summary.recalls;
  json["recall"] = {{"add", r.add},        {"add_s", r.add_s},   {"add_or_add_s", r.add_or_s},
                    {"ar", r.ar()},        {"ar_vsd", r.ar_vsd}, {"ar_mssd", r.ar_mssd},
                    {"ar_mspd", r.ar_mspd}};
  json["visibility"] = Json::array();
  for (const VisibilityBin& bin : summary.visibility) {
    Json entry{{"low", bin.low}, {"high", bin.high}};
    entry.update(tally_json(bin.tally));
    json["visibility"].push_back(entry);
  }
  json["seconds"] = {{"mean", or_null(summary.mean_seconds)}, {"median", or_null(summary.median_seconds)}};
  json["rendered"] = {{"median", or_null(summary.median_rendered)}};
  json["expanded"] = {{"mean", or_null(summary.mean_expanded)}};
  json["suboptimality_bound"] = {{"scenes", summary.bounded},
                                 {"median", or_null(summary.median_bound)},
                                 {"largest", or_null(summary.largest_bound)}};
  return json;
}

}  // namespace

std::string evaluation_json(const std::vector<MethodRecord>& methods,
                            const std::vector<MethodSummary>& summaries) {
  Json json{{"version", 1}};
  json["methods"] = Json::array();
  for (std::size_t i = 0; i < methods.size(); ++i) {
    Json method = summary_json(summaries.at(i));
    method["records"] = Json::array();
    for (const SceneRecord& scene : methods[i].scenes) method["records"].push_back(scene_json(scene));
    json["methods"].push_back(std::move(method));
  }
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace perch
