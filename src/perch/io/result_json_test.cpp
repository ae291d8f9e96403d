#include "perch/io/result_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "perch/io/test_result.hpp"

namespace perch {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys(const Json& json) {
  std::vector<std::string> out;
  for (const auto& [key, value] : json.items()) out.push_back(key);
  return out;
}
using Keys = std::vector<std::string>;

TEST(ResultJson, ReadsBackToTheBit) {
  const Result r = a_result();
  const std::string text = to_json(r);
  EXPECT_TRUE(text.ends_with("}\n"));
  const Json j = Json::parse(text);
  EXPECT_EQ(keys(j), (Keys{"version", "method", "status", "reason", "cost", "cost_observed", "cost_rendered",
                           "observed_points", "search_cost", "lower_bound", "suboptimality_bound",
                           "guarantee", "search_objects", "objects", "stats"}));
  EXPECT_EQ(j["version"], 1);
  EXPECT_EQ(j["status"], "time_limit");
  EXPECT_EQ(j["reason"], "why it ended");
  EXPECT_EQ(j["cost"], 812);
  EXPECT_EQ(j["cost_observed"], 400);
  EXPECT_EQ(j["cost_rendered"], 412);
  EXPECT_EQ(j["observed_points"], 30125);
  EXPECT_EQ(j["search_cost"], 830);
  EXPECT_EQ(j["lower_bound"], 64);
  EXPECT_EQ(j["suboptimality_bound"].get<double>(), 830.0 / 64.0);
  EXPECT_EQ(keys(j["guarantee"]),
            (Keys{"w", "over", "delta", "missing_depth", "clutter", "collision", "resolution_m",
                  "yaw_resolution_rad", "candidates", "refine", "search"}));
  EXPECT_EQ(j["guarantee"]["delta"], 0.004);
  EXPECT_EQ(j["guarantee"]["missing_depth"], "ignore");
  EXPECT_EQ(j["guarantee"]["collision"], (Json{{"penetration", 0.02}, {"overlap", 0.3}}));
  EXPECT_EQ(j["guarantee"]["clutter"], (Json{{"weight", 0.25}, {"points", "ignore"}}));
  EXPECT_EQ(j["guarantee"]["over"], r.guarantee.over);
  EXPECT_EQ(j["guarantee"]["candidates"], 3120);
  EXPECT_EQ(keys(j["search_objects"][0]), (Keys{"model", "x", "y", "yaw"}));
  EXPECT_EQ(j["search_objects"][0]["y"].get<double>(), 1.0 / 3.0);

  const Json& o = j["objects"][0];
  EXPECT_EQ(keys(o),
            (Keys{"model", "x", "y", "yaw", "world_from_model", "camera_from_model", "visible_pixels",
                  "visible_fraction", "explained_fraction", "confidence", "runner_up"}));
  EXPECT_EQ(o["confidence"].get<double>(), 0.75);
  EXPECT_EQ(keys(o["runner_up"]), (Keys{"x", "y", "yaw", "cost_increase"}));
  EXPECT_EQ(o["runner_up"]["yaw"].get<double>(), -0.125);
  EXPECT_EQ(o["runner_up"]["cost_increase"], -3);
  EXPECT_EQ(o["model"], r.objects[0].model);
  EXPECT_EQ(o["x"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(o["y"].get<double>(), -1e-17);
  EXPECT_EQ(o["yaw"].get<double>(), 3.141592653589793);
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(o["world_from_model"][i][k].get<double>(), r.objects[0].world_from_model.matrix()(i, k));
      EXPECT_EQ(o["camera_from_model"][i][k].get<double>(), r.objects[0].camera_from_model.matrix()(i, k));
    }
  EXPECT_EQ(o["visible_pixels"], 2210);
  EXPECT_EQ(keys(j["stats"]),
            (Keys{"rendered", "generated", "expanded", "threads", "ranks", "work", "seconds"}));
  EXPECT_EQ(j["stats"]["work"], (Json{{"renderings", 1800}, {"alignments", 31000}, {"pixels", 21000000}}));
  EXPECT_EQ(keys(j["stats"]["seconds"]),
            (Keys{"total", "render", "refine", "cost", "candidates", "search", "polish"}));
  EXPECT_EQ(j["stats"]["seconds"]["search"].get<double>(), 0.1);
}

TEST(ResultJson, WithoutASceneCostsAreNull) {
  Result r;
  r.status = Status::infeasible;
  const Json j = Json::parse(to_json(r));
  EXPECT_EQ(j["status"], "infeasible");
  for (const char* key : {"cost", "cost_observed", "cost_rendered", "search_cost", "suboptimality_bound"})
    EXPECT_TRUE(j[key].is_null()) << key;
  EXPECT_EQ(j["objects"], Json::array());
  EXPECT_EQ(j["search_objects"], Json::array());
  r.status = Status::time_limit;
  EXPECT_EQ(Json::parse(to_json(r))["status"], "time_limit");
}

TEST(ResultJson, WithoutABoundThereIsNoGuarantee) {
  Result r = a_result();
  EXPECT_EQ(Json::parse(to_json(r))["method"], "perch");
  r.method = "bfwor";
  r.status = Status::unproven;
  const Json j = Json::parse(to_json(r));
  EXPECT_EQ(j["method"], "bfwor");
  EXPECT_EQ(j["status"], "unproven");
  EXPECT_TRUE(j["guarantee"].is_null());
  EXPECT_EQ(j["counted_with"], (Json{{"delta", 0.004},
                                     {"missing_depth", "ignore"},
                                     {"clutter", {{"weight", 0.25}, {"points", "ignore"}}}}));
  r.guarantee.clutter.reset();
  EXPECT_FALSE(Json::parse(to_json(r))["counted_with"].contains("clutter"));
}

TEST(ResultJson, WhatWasNotJudgedIsNull) {
  Result r = a_result();
  r.objects[0].confidence.reset();
  r.objects[0].runner_up.reset();
  const Json o = Json::parse(to_json(r))["objects"][0];
  EXPECT_TRUE(o["confidence"].is_null());
  EXPECT_TRUE(o["runner_up"].is_null());
}

TEST(ResultJson, NamesThatAreNotUtf8StillWrite) {
  Result r = a_result();
  r.objects[0].model = std::string(1, '\xff');
  EXPECT_NO_THROW(Json::parse(to_json(r)));
}

TEST(ScoreJson, HasOneRecordAScene) {
  EXPECT_EQ(Json::parse(to_json(std::vector<ScoreRecord>{})), Json::array());
  const Json j = Json::parse(to_json(std::vector<ScoreRecord>{{{5, 2, 3}, 10, 20, true, false}, {}}));
  ASSERT_EQ(j.size(), 2U);
  EXPECT_EQ(keys(j[0]), (Keys{"cost", "cost_observed", "cost_rendered", "rendered_points", "observed_points",
                              "monotone", "collides"}));
  EXPECT_EQ(j[0]["cost"], 5);
  EXPECT_EQ(j[0]["rendered_points"], 10);
  EXPECT_EQ(j[0]["observed_points"], 20);
  EXPECT_EQ(j[0]["monotone"], true);
  EXPECT_EQ(j[0]["collides"], false);
}

}  // namespace
}  // namespace perch
