#pragma once

#include <cmath>

#include "command_line_test_support.hpp"

// What must hold of every result.json and trace.jsonl.
namespace perch::command_line {

inline std::vector<std::string> keys(const Json& object) {
  std::vector<std::string> out;
  for (const auto& [key, value] : object.items()) out.push_back(key);
  return out;
}

inline void check_keys(const Json& result) {
  EXPECT_THAT(keys(result), ::testing::UnorderedElementsAre(
                                "version", "method", "status", "reason", "cost", "cost_observed",
                                "cost_rendered", "observed_points", "search_cost", "lower_bound",
                                "suboptimality_bound", "guarantee", "search_objects", "objects", "stats"));
  EXPECT_EQ(result.at("version"), 1);
  EXPECT_TRUE(result.at("observed_points").is_number_integer());
  EXPECT_TRUE(result.at("lower_bound").is_number_integer());
  EXPECT_TRUE(result.at("reason").is_string());
  const Json& guarantee = result.at("guarantee");
  EXPECT_THAT(keys(guarantee), ::testing::UnorderedElementsAre(
                                   "w", "over", "delta", "missing_depth", "collision", "resolution_m",
                                   "yaw_resolution_rad", "candidates", "refine", "search"));
  for (const char* key : {"w", "resolution_m", "yaw_resolution_rad"})
    EXPECT_TRUE(guarantee.at(key).is_number()) << key;
  for (const char* key : {"over", "refine", "search"}) EXPECT_TRUE(guarantee.at(key).is_string()) << key;
  EXPECT_TRUE(guarantee.at("candidates").is_number_integer());
  const Json& stats = result.at("stats");
  EXPECT_THAT(keys(stats), ::testing::UnorderedElementsAre("rendered", "generated", "expanded", "threads",
                                                           "ranks", "work", "seconds"));
  for (const char* key : {"rendered", "generated", "expanded", "threads", "ranks"})
    EXPECT_TRUE(stats.at(key).is_number_integer()) << key;
  EXPECT_THAT(keys(stats.at("work")), ::testing::UnorderedElementsAre("renderings", "alignments", "pixels"));
  for (const Json& count : stats.at("work")) {
    EXPECT_TRUE(count.is_number_integer());
    EXPECT_GE(count, 0);
  }
  EXPECT_THAT(keys(stats.at("seconds")), ::testing::UnorderedElementsAre("total", "render", "refine", "cost",
                                                                         "candidates", "search", "polish"));
  for (const Json& seconds : stats.at("seconds")) EXPECT_TRUE(seconds.is_number());
}

inline void check_rigid(const Json& matrix) {
  ASSERT_EQ(matrix.size(), 4U);
  for (const Json& row : matrix) ASSERT_EQ(row.size(), 4U);
  EXPECT_EQ(matrix[3], Json::parse("[0, 0, 0, 1]"));
  double determinant = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto at = [&](std::size_t r, std::size_t c) { return matrix[r][c % 3].get<double>(); };
    determinant += at(0, i) * (at(1, i + 1) * at(2, i + 2) - at(1, i + 2) * at(2, i + 1));
  }
  EXPECT_NEAR(determinant, 1.0, 1e-9);
}

/// \param searched whether the objects are those of a search.
inline void check_objects(const Json& result, const std::vector<std::string>& names, bool searched = true) {
  ASSERT_EQ(result.at("objects").size(), names.size());
  std::size_t placed = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const Json& object = result["objects"][i];
    EXPECT_EQ(object.at("model"), names[i]);
    if (object.contains("absent")) {
      EXPECT_EQ(object, (Json{{"model", names[i]}, {"absent", true}}));
      continue;
    }
    ++placed;
    EXPECT_THAT(keys(object),
                ::testing::UnorderedElementsAre("model", "x", "y", "yaw", "world_from_model",
                                                "camera_from_model", "visible_pixels", "visible_fraction",
                                                "explained_fraction", "confidence", "runner_up"));
    check_rigid(object.at("world_from_model"));
    check_rigid(object.at("camera_from_model"));
    EXPECT_EQ(object["world_from_model"][0][3], object["x"]);
    EXPECT_EQ(object["world_from_model"][1][3], object["y"]);
    EXPECT_NEAR(object["world_from_model"][0][0], std::cos(object["yaw"].get<double>()), 1e-9);
    EXPECT_TRUE(object.at("visible_pixels").is_number_integer());
    for (const char* key : {"visible_fraction", "explained_fraction"}) {
      EXPECT_GE(object.at(key), 0.0) << key;
      EXPECT_LE(object.at(key), 1.0) << key;
    }
    const Json &confidence = object.at("confidence"), &runner_up = object.at("runner_up");
    if (!confidence.is_null()) {
      EXPECT_GE(confidence, 0.0);
      EXPECT_LE(confidence, 1.0);
    }
    if (!runner_up.is_null()) {
      EXPECT_FALSE(confidence.is_null());
      EXPECT_THAT(keys(runner_up), ::testing::UnorderedElementsAre("x", "y", "yaw", "cost_increase"));
      EXPECT_TRUE(runner_up["cost_increase"].is_number_integer());
    }
  }
  ASSERT_EQ(result.at("search_objects").size(), searched ? placed : 0);
  for (const Json& object : result["search_objects"])
    EXPECT_THAT(keys(object), ::testing::UnorderedElementsAre("model", "x", "y", "yaw"));
}

inline void check_certificate(const Json& result) {
  const std::int64_t cost = result.at("cost"), search_cost = result.at("search_cost"),
                     lower_bound = result.at("lower_bound");
  const double w = result.at("guarantee").at("w");
  EXPECT_EQ(cost,
            result.at("cost_observed").get<std::int64_t>() + result["cost_rendered"].get<std::int64_t>());
  EXPECT_GE(result["cost_observed"], 0);
  EXPECT_GE(result["cost_rendered"], 0);
  EXPECT_LE(result["cost_observed"], result["observed_points"]);
  EXPECT_LE(cost, search_cost);
  EXPECT_LE(lower_bound, search_cost);
  EXPECT_GE(lower_bound, 0);
  const Json& bound = result.at("suboptimality_bound");
  if (lower_bound > 0)
    EXPECT_EQ(bound.get<double>(), static_cast<double>(search_cost) / static_cast<double>(lower_bound));
  else if (search_cost == 0)
    EXPECT_EQ(bound, 1.0);
  else
    EXPECT_TRUE(bound.is_null());
  const bool proven = static_cast<double>(search_cost) <= w * static_cast<double>(lower_bound);
  EXPECT_EQ(result.at("status"), proven ? "solved" : "time_limit");
}

/// Each line of a trace is no worse than the one before, and the last says what the result says.
inline void check_trace(const std::string& trace, const Json& result) {
  std::istringstream lines(trace);
  Json last;
  for (std::string line; std::getline(lines, line);) {
    const Json entry = Json::parse(line);
    EXPECT_THAT(keys(entry),
                ::testing::UnorderedElementsAre("seconds", "cost", "search_cost", "lower_bound", "expanded"));
    EXPECT_GE(entry.at("seconds"), last.is_null() ? 0.0 : last["seconds"].get<double>());
    if (!last.is_null()) {
      EXPECT_GE(entry.at("lower_bound"), last["lower_bound"]);
      EXPECT_GE(entry.at("expanded"), last["expanded"]);
      for (const char* key : {"cost", "search_cost"})
        if (!last[key].is_null()) {
          EXPECT_LE(entry.at(key), last[key]) << key;
        }
    }
    if (!entry.at("search_cost").is_null()) {
      EXPECT_LE(entry.at("lower_bound"), entry["search_cost"]);
    }
    last = entry;
  }
  ASSERT_FALSE(last.is_null());
  for (const char* key : {"cost", "search_cost", "lower_bound"})
    EXPECT_EQ(last.at(key), result.at(key)) << key;
  EXPECT_EQ(last.at("expanded"), result.at("stats").at("expanded"));
  EXPECT_LE(last.at("seconds"), result.at("stats").at("seconds").at("total"));
}

}  // namespace perch::command_line
