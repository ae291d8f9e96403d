#include "perch/io/result_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "perch/core/random.hpp"
#include "perch/io/result_json.hpp"
#include "perch/io/test_files.hpp"
#include "perch/io/test_result.hpp"

namespace perch {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_files::input_error;
using testing_files::TemporaryDirectory;
using Json = nlohmann::ordered_json;

Scene scene() {
  Scene scene;
  scene.models.resize(2);
  scene.models[0].name = "mug";
  scene.models[1].name = "can\xff";  // not UTF-8
  scene.objects = {0, 1};
  return scene;
}

ReportedResult read(const std::string& text) {
  const TemporaryDirectory directory;
  return read_result(directory.write("result.json", text), scene());
}

TEST(ResultFile, ReadsAResultWithoutABound) {
  Result r = a_result();
  r.method = "ppf";
  r.status = Status::unproven;
  const ReportedResult read_back = read(to_json(r));
  EXPECT_EQ(read_back.method, "ppf");
  EXPECT_EQ(read_back.status, Status::unproven);
  EXPECT_FALSE(read_back.has_bound());
  EXPECT_EQ(read_back.guarantee.delta, 0.004);
  EXPECT_EQ(read_back.guarantee.missing_depth, "ignore");
  ASSERT_TRUE(read_back.guarantee.clutter);
  EXPECT_EQ(read_back.guarantee.clutter->weight, 0.25);
  EXPECT_EQ(read_back.guarantee.clutter->points, "ignore");
  EXPECT_EQ(read_back.cost, 812);
}

TEST(ResultFile, WithoutAMethodItIsOneOfPerch) {
  Json json = Json::parse(to_json(a_result()));
  json.erase("method");
  const ReportedResult read_back = read(json.dump());
  EXPECT_EQ(read_back.method, "perch");
  EXPECT_EQ(read_back.guarantee.w, 1.5);
}

TEST(ResultFile, ReadsWhatIsWritten) {
  const Result r = a_result();
  const ReportedResult read_back = read(to_json(r));
  EXPECT_EQ(read_back.status, Status::time_limit);
  EXPECT_EQ(read_back.cost, 812);
  EXPECT_EQ(read_back.cost_observed, 400);
  EXPECT_EQ(read_back.cost_rendered, 412);
  EXPECT_EQ(read_back.observed_points, 30125);
  EXPECT_EQ(read_back.search_cost, 830);
  EXPECT_EQ(read_back.lower_bound, 64);
  EXPECT_EQ(read_back.suboptimality_bound, 830.0 / 64.0);
  EXPECT_EQ(read_back.guarantee.w, 1.5);
  EXPECT_EQ(read_back.guarantee.over, "scenes");
  EXPECT_EQ(read_back.guarantee.delta, 0.004);
  EXPECT_EQ(read_back.guarantee.missing_depth, "ignore");
  EXPECT_EQ(read_back.guarantee.collision_penetration, 0.02);
  EXPECT_EQ(read_back.guarantee.collision_overlap, 0.3);
  EXPECT_EQ(read_back.guarantee.candidates, 3120);
  ASSERT_EQ(read_back.search_objects.size(), 2U);
  EXPECT_EQ(read_back.search_objects[0].model, 1U);
  EXPECT_EQ(read_back.search_objects[0].pose, r.search_objects[0].pose);
  EXPECT_EQ(read_back.search_objects[1].model, 0U);
  ASSERT_EQ(read_back.objects.size(), 2U);
  const ReportedObject& mug = read_back.objects[0];
  EXPECT_EQ(mug.model, 0U);
  EXPECT_FALSE(mug.absent);
  EXPECT_EQ(mug.pose, r.objects[0].pose);
  EXPECT_EQ(mug.world_from_model, r.objects[0].world_from_model.matrix());
  EXPECT_EQ(mug.camera_from_model, r.objects[0].camera_from_model.matrix());
  EXPECT_EQ(mug.visible_pixels, 2210);
  EXPECT_EQ(mug.visible_fraction, 1.0 / 7.0);
  EXPECT_EQ(mug.explained_fraction, 0.97);
  EXPECT_EQ(mug.confidence, 0.75);
  ASSERT_TRUE(mug.runner_up);
  EXPECT_EQ(mug.runner_up->pose, (Pose{0.5, 0.25, -0.125}));
  EXPECT_EQ(mug.runner_up->cost_increase, -3);
  EXPECT_EQ(read_back.objects[1].confidence, std::nullopt);
  EXPECT_FALSE(read_back.objects[1].runner_up);
  EXPECT_EQ(read_back.objects[1].model, 1U);
  EXPECT_EQ(read_back.stats.rendered, 15564);
  EXPECT_EQ(read_back.stats.threads, 4);
  EXPECT_EQ(read_back.stats.seconds.search, 0.1);
  EXPECT_EQ(read_back.stats.work, r.stats.work);
}

TEST(ResultFile, RestPosesAreWrittenOnlyWhereThereAreSeveral) {
  Result r = a_result();
  EXPECT_EQ(to_json(r).find("rest_pose"), std::string::npos);
  r.objects[0].rest_pose = 1;
  r.objects[0].runner_up->rest_pose = 0;
  r.search_objects[1].rest_pose = 1;
  Scene resting = scene();  // the mug in two ways, and the can
  resting.models.insert(resting.models.begin() + 1, resting.models[0]);
  resting.models[1].rest_pose = 1;
  resting.objects = {0, 2};
  const TemporaryDirectory directory;
  const auto file = directory.write("result.json", to_json(r));
  const ReportedResult read_back = read_result(file, resting);
  EXPECT_EQ(read_back.objects[0].model, 1U);
  EXPECT_EQ(read_back.objects[0].runner_up->rest_pose, 0);
  EXPECT_EQ(read_back.objects[1].model, 2U);
  EXPECT_EQ(read_back.search_objects[0].model, 2U);
  EXPECT_EQ(read_back.search_objects[1].model, 1U);

  Json json = Json::parse(to_json(r));
  for (const Json& index : {Json(2), Json(-1), Json(0.5), Json("one"), Json(nullptr), Json(1e300)}) {
    json["objects"][0]["rest_pose"] = index;
    const auto bad = directory.write("bad.json", json.dump());
    EXPECT_THAT(input_error([&] { read_result(bad, resting); }), HasSubstr("objects[0].rest_pose: "));
  }
  EXPECT_THAT(input_error([&] { read_result(file, scene()); }), HasSubstr("rest_pose"));
}

TEST(ResultFile, ReadsNullsAndAbsentObjects) {
  Json json = Json::parse(to_json(a_result()));
  for (const char* key : {"cost", "cost_observed", "cost_rendered", "search_cost", "suboptimality_bound"})
    json[key] = nullptr;
  json["objects"] = Json::array({Json{{"model", "mug"}, {"absent", true}}});
  json["search_objects"] = Json::array();
  json["status"] = "infeasible";
  const ReportedResult read_back = read(json.dump());
  EXPECT_EQ(read_back.status, Status::infeasible);
  EXPECT_EQ(read_back.cost, std::nullopt);
  EXPECT_EQ(read_back.search_cost, std::nullopt);
  EXPECT_EQ(read_back.suboptimality_bound, std::nullopt);
  ASSERT_EQ(read_back.objects.size(), 1U);
  EXPECT_TRUE(read_back.objects[0].absent);
  EXPECT_TRUE(read_back.search_objects.empty());
}

TEST(ResultFile, SkipsKeysThatItDoesNotKnow) {
  Json json = Json::parse(to_json(a_result()));
  json["note"] = Json::array({1, "two"});
  json["objects"][0]["ambiguous"] = true;
  EXPECT_EQ(read(json.dump()).cost, 812);
}

TEST(ResultFile, WholeNumbersMayBeWrittenWithAPoint) {
  Json json = Json::parse(to_json(a_result()));
  json["cost"] = 812.0;
  json["lower_bound"] = -3;  // wrong, but a whole number
  EXPECT_EQ(read(json.dump()).cost, 812);
  EXPECT_EQ(read(json.dump()).lower_bound, -3);
}

struct Broken {
  std::function<void(Json&)> make;
  std::vector<std::string> words;
};

TEST(ResultFile, RefusesWhatIsNoResult) {
  const std::vector<Broken> all{
      {[](Json& r) { r["version"] = 2; }, {"version", "2"}},
      {[](Json& r) { r["status"] = "solve"; }, {"status", "\"solve\"", "did you mean solved"}},
      {[](Json& r) { r["status"] = nullptr; }, {"status", "null"}},
      {[](Json& r) { r["cost"] = 812.5; }, {"cost", "812.5", "whole"}},
      {[](Json& r) { r["cost"] = "812"; }, {"cost", "\"812\"", "not a number"}},
      {[](Json& r) { r["cost"] = 9007199254740993; }, {"cost", "9007199254740993"}},
      {[](Json& r) { r["observed_points"] = nullptr; }, {"observed_points", "null"}},
      {[](Json& r) { r["lower_bound"] = true; }, {"lower_bound", "true"}},
      {[](Json& r) { r["suboptimality_bound"] = Json::array(); }, {"suboptimality_bound", "a list"}},
      {[](Json& r) { r["guarantee"] = 3; }, {"guarantee", "a map is expected"}},
      {[](Json& r) { r["guarantee"]["collision"]["overlap"] = "x"; }, {"guarantee.collision.overlap"}},
      {[](Json& r) { r["objects"] = Json::object(); }, {"objects", "a map", "a list is expected"}},
      {[](Json& r) { r["objects"][0] = 1; }, {"objects[0]", "a map is expected"}},
      {[](Json& r) { r["objects"][0]["model"] = "mugs"; },
       {"objects[0].model", "\"mugs\"", "did you mean mug"}},
      {[](Json& r) { r["objects"][0]["confidence"] = "sure"; }, {"objects[0].confidence", "\"sure\""}},
      {[](Json& r) { r["objects"][0]["runner_up"]["cost_increase"] = 0.5; },
       {"objects[0].runner_up.cost_increase", "0.5"}},
      {[](Json& r) { r["objects"][0]["absent"] = 1; }, {"objects[0].absent", "neither true nor false"}},
      {[](Json& r) { r["objects"][0]["world_from_model"].erase(3); },
       {"objects[0].world_from_model", "3 rows"}},
      {[](Json& r) { r["objects"][0]["world_from_model"][1].push_back(0); },
       {"objects[0].world_from_model[1]", "5 values"}},
      {[](Json& r) { r["objects"][0]["world_from_model"][1][2] = nullptr; },
       {"objects[0].world_from_model[1][2]"}},
      {[](Json& r) { r["search_objects"][1]["x"] = 2e6; }, {"search_objects[1].x", "2000000.0"}},
      {[](Json& r) { r["search_objects"][1]["model"] = 7; }, {"search_objects[1].model", "7", "not text"}},
      {[](Json& r) { r["search_objects"] = Json(1001, r["search_objects"][0]); }, {"search_objects", "1001"}},
      {[](Json& r) { r["stats"]["threads"] = 0; }, {"stats.threads", "0"}},
      {[](Json& r) { r["stats"]["seconds"]["total"] = "1"; }, {"stats.seconds.total"}},
      {[](Json& r) { r["stats"]["work"]["pixels"] = 0.5; }, {"stats.work.pixels", "0.5"}},
  };
  for (const Broken& broken : all) {
    Json json = Json::parse(to_json(a_result()));
    broken.make(json);
    SCOPED_TRACE(testing::PrintToString(broken.words));
    const std::string message = input_error([&] { read(json.dump()); });
    EXPECT_THAT(message, HasSubstr("result.json: "));
    for (const std::string& word : broken.words) EXPECT_THAT(message, HasSubstr(word));
  }
}

/// Calls `visit` with every key that stands in a map, of a list's elements in the first only.
void for_each_key(Json& json, const std::function<void(Json& owner, const std::string& key)>& visit) {
  if (json.is_array() && !json.empty()) return for_each_key(json[0], visit);
  if (!json.is_object()) return;
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  for (const std::string& key : keys) {
    for_each_key(json[key], visit);
    visit(json, key);
  }
}

TEST(ResultFile, EveryKeyMustBeThere) {
  Json json = Json::parse(to_json(a_result()));
  int keys = 0;
  for_each_key(json, [&](Json& owner, const std::string& key) {
    for (const char* may_lack :
         {"method", "reason", "confidence", "runner_up", "candidates", "polish", "work"})
      if (key == may_lack && !owner.contains("w")) return;  // words, estimates, times of stages, counters
    if (key == "clutter") return;                           // only where there may be some
    ++keys;
    const Json kept = owner;
    owner.erase(key);
    SCOPED_TRACE(key);
    EXPECT_THAT(input_error([&] { read(json.dump()); }), AllOf(HasSubstr(key), HasSubstr("is missing")));
    owner = kept;
  });
  EXPECT_GT(keys, 45);
}

TEST(ResultFile, RefusesWhatIsNoJson) {
  const std::string good = to_json(a_result());
  for (const std::string& text :
       {std::string("x"), good.substr(0, good.size() / 2), good + "]", "[" + good + "]", std::string("null"),
        std::string("\xff\xfe{}", 4), std::string("{\"version\": 1e999}"), std::string("{\"version\": NaN}"),
        std::string(100, '\0')})
    EXPECT_THAT(input_error([&] { read(text); }), HasSubstr("result.json: ")) << text.substr(0, 20);
  EXPECT_THAT(input_error([&] { read(""); }), HasSubstr("is empty"));
  EXPECT_THAT(input_error([&] { read_result("no/such/result.json", scene()); }), HasSubstr("no such file"));
}

TEST(ResultFile, RefusesRepeatedKeysAndDeepNests) {
  const std::string good = to_json(a_result());
  EXPECT_THAT(input_error([&] { read(testing_files::replaced(good, "{", "{\"cost\": 1, ")); }),
              AllOf(HasSubstr("cost"), HasSubstr("twice")));
  const std::string deep = std::string(100'000, '[');
  EXPECT_THAT(input_error([&] { read(deep); }), HasSubstr("nested"));
  std::string maps;
  for (int i = 0; i < 50'000; ++i) maps += "{\"a\":";
  EXPECT_THAT(input_error([&] { read(maps); }), HasSubstr("nested"));
}

// Whatever the bytes are, the answer is a result or one clear line.
TEST(ResultFile, DamagedFilesAreReadOrRefused) {
  const std::string good = to_json(a_result());
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::string text = good;
    for (std::uint64_t i = 0; i <= random.below(4); ++i) {
      const std::size_t at = random.below(text.size());
      switch (random.below(3)) {
        case 0:
          text[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          text.erase(at, 1 + random.below(20));
          break;
        default:
          text.insert(at, text.substr(random.below(text.size()), random.below(30)));
      }
      if (text.empty()) break;
    }
    try {
      read(text);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace perch
