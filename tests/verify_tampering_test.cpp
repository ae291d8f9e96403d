// A true result verifies; one that was tampered with, by as little as can be told, does not.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "perch/localize/localize.hpp"
#include "perch/sim/scene_generator.hpp"
#include "verify_test_support.hpp"

namespace perch {
namespace {

using testing::Contains;
using testing::IsEmpty;
using testing_verify::range_of;
using testing_verify::verify_text;
using testing_verify::wrong_of;
using Json = nlohmann::json;

/// A result of a small scene, found by the program, and what verifying it says.
struct TrueResult {
  Scene scene;
  Json json;
  Checks checks;
};

const TrueResult& true_result() {
  static const TrueResult result = [] {
    TabletopOptions options;
    options.min_objects = options.max_objects = 3;
    options.models = {"can", "mug", "carton"};
    options.repeats = false;
    options.width = 240;
    options.height = 180;
    options.least_visible = 0.4;
    TrueResult r{random_tabletop(5, options).scene, {}, {}};
    Settings settings;
    settings.candidates.grid.resolution = 0.08;
    settings.candidates.grid.yaw_resolution = std::numbers::pi / 4.0;
    r.json = Json::parse(to_json(localize(r.scene, settings, SerialExecutor(), StopCondition())));
    r.checks = verify_text(r.scene, r.json.dump());
    return r;
  }();
  return result;
}

TEST(VerifyTampering, TheResultItselfHolds) {
  EXPECT_THAT(wrong_of(true_result().checks), IsEmpty());
  EXPECT_EQ(true_result().json.at("objects").size(), 3U);
  EXPECT_LE(range_of(true_result().checks, "cost").width(), 5);
  EXPECT_THAT(wrong_of(verify_text(true_result().scene, true_result().json.dump())), IsEmpty());
}

void put_bound(Json& result) {
  result["suboptimality_bound"] =
      result["search_cost"].get<double>() / std::max(1.0, result["lower_bound"].get<double>());
}

/// Moves an object and all that is written of its pose, as one who knows the format would.
void move(Json& result, std::size_t i, double dx, double dy, double dyaw) {
  const Scene& scene = true_result().scene;
  for (const char* list : {"objects", "search_objects"}) {
    Json& object = result[list][i];
    object["x"] = object["x"].get<double>() + dx;
    object["y"] = object["y"].get<double>() + dy;
    object["yaw"] = object["yaw"].get<double>() + dyaw;
  }
  Json& object = result["objects"][i];
  const Eigen::Isometry3d pose =
      world_from_model({object["x"], object["y"], object["yaw"]}, scene.table_height.value());
  const Eigen::Isometry3d seen = scene.camera.world_from_camera.inverse() * pose;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) {
      object["world_from_model"][r][c] = pose.matrix()(r, c);
      object["camera_from_model"][r][c] = seen.matrix()(r, c);
    }
}

void add(Json& value, double step) {
  value = value.get<double>() + step;
}

struct Tampering {
  const char* what;
  std::function<void(Json&)> make;
  const char* wrong;  ///< the check that must find it
};

/// One more, or one fewer, than rounding allows, with all that hangs together changed alike.
void put_cost(Json& r, std::int64_t cost) {
  const std::int64_t step = cost - r["cost"].get<std::int64_t>();
  r["cost"] = cost;
  r["cost_rendered"] = r["cost_rendered"].get<std::int64_t>() + step;
  r["search_cost"] = cost;
  r["lower_bound"] = std::min(r["lower_bound"].get<std::int64_t>(), cost);
  put_bound(r);
}
std::int64_t above(const char* check) {
  return range_of(true_result().checks, check).high + 1;
}
std::int64_t below(const char* check) {
  return range_of(true_result().checks, check).low - 1;
}

std::vector<Tampering> tamperings() {
  return {
      Tampering{"cost_above", [](Json& r) { put_cost(r, above("cost")); }, "cost"},
      Tampering{"cost_below", [](Json& r) { put_cost(r, below("cost")); }, "cost"},
      Tampering{"costs_do_not_add_up", [](Json& r) { add(r["cost_observed"], 1); },
                "cost = cost_observed + cost_rendered"},
      Tampering{"points_from_observed_to_rendered",
                [](Json& r) {
                  const std::int64_t step = above("cost_rendered") - r["cost_rendered"].get<std::int64_t>();
                  add(r["cost_rendered"], static_cast<double>(step));
                  add(r["cost_observed"], -static_cast<double>(step));
                },
                "cost_rendered"},
      Tampering{"search_cost_above",
                [](Json& r) {
                  r["search_cost"] = above("search_cost");
                  put_bound(r);
                },
                "search_cost"},
      Tampering{"observed_points", [](Json& r) { add(r["observed_points"], 1); }, "observed_points"},
      Tampering{"a_centimetre_along_x", [](Json& r) { move(r, 0, 0.01, 0.0, 0.0); }, "cost"},
      Tampering{"a_centimetre_along_y", [](Json& r) { move(r, 1, 0.0, 0.01, 0.0); }, "cost"},
      Tampering{"two_millimetres", [](Json& r) { move(r, 2, 0.0, 0.002, 0.0); }, "cost"},
      Tampering{"turned_by_5_degrees", [](Json& r) { move(r, 1, 0.0, 0.0, 0.09); }, "cost"},
      Tampering{"x_alone", [](Json& r) { add(r["objects"][0]["x"], 1e-6); }, "objects[0].world_from_model"},
      Tampering{"yaw_alone", [](Json& r) { add(r["objects"][2]["yaw"], 1e-6); },
                "objects[2].world_from_model"},
      Tampering{"world_matrix", [](Json& r) { add(r["objects"][1]["world_from_model"][2][3], 1e-6); },
                "objects[1].world_from_model"},
      Tampering{"camera_matrix", [](Json& r) { add(r["objects"][1]["camera_from_model"][0][2], 1e-6); },
                "objects[1].camera_from_model"},
      Tampering{"search_object_moved", [](Json& r) { add(r["search_objects"][0]["x"], 0.01); },
                "search_cost"},
      Tampering{"records_swapped", [](Json& r) { std::swap(r["objects"][0], r["objects"][1]); },
                "objects[0].model"},
      Tampering{"names_swapped",
                [](Json& r) { std::swap(r["objects"][0]["model"], r["objects"][1]["model"]); },
                "objects[1].model"},
      Tampering{"poses_swapped",
                [](Json& r) {
                  for (const char* key : {"x", "y", "yaw", "world_from_model", "camera_from_model"})
                    std::swap(r["objects"][0][key], r["objects"][1][key]);
                },
                "cost"},
      Tampering{"search_object_missing", [](Json& r) { r["search_objects"].erase(1); },
                "search_objects: mug"},
      Tampering{"objects_missing", [](Json& r) { r["objects"].clear(); }, "objects, how many"},
      Tampering{"visible_pixels_above",
                [](Json& r) { r["objects"][0]["visible_pixels"] = above("objects[0].visible_pixels"); },
                "objects[0].visible_pixels"},
      Tampering{"visible_pixels_below",
                [](Json& r) { r["objects"][1]["visible_pixels"] = below("objects[1].visible_pixels"); },
                "objects[1].visible_pixels"},
      Tampering{"visible_fraction", [](Json& r) { add(r["objects"][1]["visible_fraction"], -1e-6); },
                "objects[1].visible_fraction"},
      Tampering{"visible_fraction_of_nothing", [](Json& r) { r["objects"][1]["visible_fraction"] = 0.0; },
                "objects[1].visible_fraction"},
      Tampering{"explained_fraction", [](Json& r) { add(r["objects"][2]["explained_fraction"], -1e-6); },
                "objects[2].explained_fraction"},
      Tampering{"explained_fraction_by_pixels",
                [](Json& r) {
                  Json& o = r["objects"][2];
                  add(o["explained_fraction"], -10.0 / o["visible_pixels"].get<double>());
                },
                "objects[2].explained_fraction"},
      Tampering{"cost_increase",
                [](Json& r) {
                  r["objects"][0]["runner_up"]["cost_increase"] = above("objects[0].runner_up.cost_increase");
                },
                "objects[0].runner_up.cost_increase"},
      Tampering{"runner_up_moved", [](Json& r) { add(r["objects"][1]["runner_up"]["y"], 0.02); },
                "objects[1].runner_up.cost_increase"},
      Tampering{"confidence", [](Json& r) { r["objects"][1]["confidence"] = 1.01; }, "objects[1].confidence"},
      Tampering{"lower_bound_above_search_cost",
                [](Json& r) {
                  r["lower_bound"] = r["search_cost"].get<std::int64_t>() + 1;
                  put_bound(r);
                },
                "lower_bound <= search_cost"},
      Tampering{"lower_bound_alone", [](Json& r) { add(r["lower_bound"], -1); }, "suboptimality_bound"},
      Tampering{"suboptimality_bound", [](Json& r) { add(r["suboptimality_bound"], -1e-9); },
                "suboptimality_bound"},
      Tampering{"time_limit_for_solved", [](Json& r) { r["status"] = "time_limit"; }, "status"},
      Tampering{"infeasible_for_solved", [](Json& r) { r["status"] = "infeasible"; }, "status"},
      Tampering{"solved_for_time_limit",
                [](Json& r) {
                  r["lower_bound"] = 1;
                  put_bound(r);
                },
                "status"},
      Tampering{"delta", [](Json& r) { r["guarantee"]["delta"] = 0.0045; }, "cost"},
      Tampering{"one_inside_another",
                [](Json& r) {
                  const auto offset = [&](const char* key) {
                    return r["objects"][0][key].get<double>() - r["objects"][2][key].get<double>();
                  };
                  move(r, 2, offset("x"), offset("y"), 0.0);
                },
                "objects[0] and [2] don't collide"}};
}

TEST(VerifyTampering, IsFound) {
  for (const Tampering& tampering : tamperings()) {
    SCOPED_TRACE(tampering.what);
    Json json = true_result().json;
    tampering.make(json);
    EXPECT_NE(json, true_result().json);
    EXPECT_THAT(wrong_of(verify_text(true_result().scene, json.dump())), Contains(tampering.wrong));
  }
}

TEST(Verify, ResultsWithoutASceneHold) {
  Json r = true_result().json;
  for (const char* key : {"cost", "cost_observed", "cost_rendered", "search_cost", "suboptimality_bound"})
    r[key] = nullptr;
  r["objects"] = r["search_objects"] = Json::array();
  r["lower_bound"] = 0;
  for (const char* status : {"time_limit", "infeasible"}) {
    r["status"] = status;
    EXPECT_THAT(wrong_of(verify_text(true_result().scene, r.dump())), IsEmpty());
  }
  r["status"] = "solved";
  EXPECT_THAT(wrong_of(verify_text(true_result().scene, r.dump())), testing::ElementsAre("status"));
}

}  // namespace
}  // namespace perch
