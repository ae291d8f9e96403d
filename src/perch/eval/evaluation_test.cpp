#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "perch/core/random.hpp"
#include "perch/eval/comparison.hpp"
#include "perch/eval/figures.hpp"
#include "perch/eval/gnuplot.hpp"
#include "perch/eval/report.hpp"
#include "perch/eval/scene_evaluator.hpp"
#include "perch/eval/summary.hpp"
#include "perch/eval/tables.hpp"
#include "perch/eval/test_shapes.hpp"
#include "perch/eval/visible_fractions.hpp"
#include "perch/io/test_files.hpp"

// Records of whole scenes, what is made of them, and the files that are written.
namespace perch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;
using testing_files::bytes_of;
using testing_files::TemporaryDirectory;

/// A camera 1 m above the plane that looks straight down on blocks of 6 x 4 x 5 cm and square ones of 5 x 5 x
/// 5 cm; 320 pixels wide.
Scene scene_of(const std::vector<TruthPose>& truth) {
  Scene scene;
  scene.camera.intrinsics = {320, 240, 300.0, 300.0, 159.5, 119.5};
  scene.camera.world_from_camera.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  scene.camera.world_from_camera.translation() << 0, 0, 1;
  scene.depth = DepthImage(320, 240);
  scene.models = {{"block", testing_eval::box(0.06F, 0.04F, 0.05F), Symmetry::none(), 0.0},
                  {"square", testing_eval::box(0.05F, 0.05F, 0.05F), Symmetry::n_fold(4), 0.0}};
  scene.truth = truth;
  for (const TruthPose& object : truth) scene.objects.emplace_back(object.model);
  return scene;
}

ReportedResult result_of(const std::vector<PlacedModel>& placed) {
  ReportedResult result;
  result.status = Status::solved;
  result.stats.seconds.total = 2.5;
  for (const PlacedModel& object : placed) {
    result.objects.emplace_back();
    result.objects.back().model = object.model;
    result.objects.back().pose = object.pose;
  }
  return result;
}

constexpr double degree = degrees(1.0);

const std::vector<TruthPose> three_blocks{{0, {-0.2, 0.0, 0.1}, Symmetry::none()},
                                          {1, {0.2, 0.0, 0.0}, Symmetry::n_fold(4)},
                                          {0, {0.0, 0.1, -2.0}, Symmetry::none()}};

TEST(SceneEvaluator, TheTruthIsRightByEveryMetric) {
  const Scene scene = scene_of(three_blocks);
  const SceneRecord record =
      SceneEvaluator(scene, "s", 0.0)
          .evaluate(result_of({{0, three_blocks[2].pose}, {0, three_blocks[0].pose}, {1, {0.2, 0.0, 0.0}}}),
                    [](const auto&) -> std::vector<std::int64_t> { throw std::logic_error("not needed"); });
  ASSERT_THAT(record.objects, SizeIs(3));
  EXPECT_EQ(record.surplus, 0U);
  EXPECT_EQ(record.run->seconds, 2.5);
  for (const ObjectRecord& object : record.objects) {
    ASSERT_TRUE(object.errors);
    for (const double error : {object.errors->translation, object.errors->yaw, object.errors->add,
                               object.errors->add_s, object.errors->mssd, object.errors->mspd})
      EXPECT_NEAR(error, 0.0, 1e-6);
    EXPECT_THAT(object.errors->vsd, testing::Each(0.0));
    EXPECT_EQ(object.visible_fraction, 1.0);
    EXPECT_EQ(object.verdict(tightest_threshold), Verdict::within);
  }
  EXPECT_NEAR(record.objects[1].diameter, 0.05 * std::sqrt(3.0), 1e-8);
  EXPECT_TRUE(record.objects[1].symmetric);
}

TEST(SceneEvaluator, AShiftIsFoundByEveryMetric) {
  const Scene scene = scene_of({{1, {0.0, 0.0, 0.0}, Symmetry::n_fold(4)}});
  const PoseErrors errors = *SceneEvaluator(scene, "s", 0.0)
                                 .evaluate(result_of({{1, {0.03, 0.04, 93.0 * degree}}}))
                                 .objects.at(0)
                                 .errors;
  EXPECT_NEAR(errors.translation, 0.05, 1e-12);
  EXPECT_NEAR(errors.yaw, 3.0 * degree, 1e-12);
  // The top, 0.95 m away, moves by 5 cm and at most the chord of 3 degrees; pixels are those of an image 640
  // wide.
  const double chord = 0.05 * std::sqrt(2.0) * std::sin(1.5 * degree);
  EXPECT_NEAR(errors.mssd, 0.05, chord + 1e-6);
  EXPECT_NEAR(errors.mspd, 2.0 * 300.0 * 0.05 / 0.95, 2.0 * 300.0 * chord / 0.95 + 1e-6);
  EXPECT_GT(errors.vsd[0], 0.5);
}

TEST(SceneEvaluator, HeightsAreThoseOfThePlaneAndTheModel) {
  Scene scene = scene_of({{0, {}, Symmetry::none()}});
  scene.models[0].base = 0.35;  // its top at 0.5 m below a camera at 1 m, with the plane at 0.1 m
  const PoseErrors errors =
      *SceneEvaluator(scene, "s", 0.1).evaluate(result_of({{0, {0.01, 0.0, 0.0}}})).objects.at(0).errors;
  EXPECT_NEAR(errors.mspd, 2.0 * 300.0 * 0.01 / 0.5, 1e-4);
}

// 9 found of which 5 stand in for the 5 true ones: the sum over pairs is the least of all permutations.
TEST(SceneEvaluator, RepeatsAreAssignedAtTheLeastSum) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto anywhere = [&]() -> Pose {
      return {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-3.0, 3.0)};
    };
    std::vector<TruthPose> truth;
    std::vector<PlacedModel> found;
    for (int i = 0; i < 4; ++i) truth.push_back({0, anywhere(), Symmetry::n_fold(2)});
    for (int i = 0; i < 6; ++i) found.push_back({0, anywhere()});
    const Scene scene = scene_of(truth);
    const SceneRecord record = SceneEvaluator(scene, "s", 0.0).evaluate(result_of(found));
    const auto cost = [](double translation, double yaw) {
      return std::min(0.1, translation) + 0.01 * yaw / std::numbers::pi;
    };
    double sum = 0.0;
    for (const ObjectRecord& object : record.objects)
      sum += cost(object.errors->translation, object.errors->yaw);
    std::vector<std::size_t> order(found.size());
    std::iota(order.begin(), order.end(), 0);
    double least = INFINITY;
    do {
      double all = 0.0;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        const Pose& a = truth[i].pose;
        const Pose& b = found[order[i]].pose;
        all += cost(std::hypot(a.x - b.x, a.y - b.y), truth[i].symmetry.yaw_difference(a.yaw, b.yaw));
      }
      least = std::min(least, all);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(sum, least, 1e-12);
    EXPECT_EQ(record.surplus, 2U);
  }
}

TEST(SceneEvaluator, AbsentObjectsAndOtherModelsStandForNone) {
  const Scene scene = scene_of(three_blocks);
  ReportedResult result =
      result_of({{0, three_blocks[0].pose}, {0, three_blocks[2].pose}, {0, {0.2, 0.0, 0.0}}});
  result.objects[1].absent = true;
  const SceneRecord record = SceneEvaluator(scene, "s", 0.0).evaluate(result);
  EXPECT_TRUE(record.objects[0].errors);
  EXPECT_FALSE(record.objects[1].errors);  // a block where the square is
  EXPECT_TRUE(record.objects[2].errors);   // that block stands for this one, though far away
  EXPECT_EQ(record.objects[2].verdict({0.1, 4.0}), Verdict::missed);
  EXPECT_EQ(record.surplus, 0U);
}

TEST(SceneEvaluator, WithoutAResultAllIsMissed) {
  const Scene scene = scene_of(three_blocks);
  const SceneRecord record = SceneEvaluator(scene, "s", 0.0).missing();
  EXPECT_FALSE(record.run);
  ASSERT_THAT(record.objects, SizeIs(3));
  for (const ObjectRecord& object : record.objects) EXPECT_EQ(object.verdict({1.0, 4.0}), Verdict::missed);
}

TEST(SceneEvaluator, IsAmbiguousWhatCostsNoMoreThanTheTruth) {
  const Scene scene = scene_of(three_blocks);
  const Pose turned{-0.2, 0.0, 0.1 + std::numbers::pi};
  std::vector<std::vector<PlacedModel>> asked;
  const auto costs = [&](std::int64_t of_turned, std::int64_t of_far) {
    return [&asked, of_turned, of_far](const std::vector<std::vector<PlacedModel>>& arrangements) {
      asked = arrangements;
      return std::vector<std::int64_t>{100, of_turned, of_far};
    };
  };
  const ReportedResult result = result_of({{0, turned}, {0, {0.0, 0.15, -2.0}}, {1, {0.2, 0.0, 0.0}}});
  const SceneRecord record = SceneEvaluator(scene, "s", 0.0).evaluate(result, costs(100, 101));
  // The truth, and the truth with one object at a time where it was found.
  ASSERT_THAT(asked, ElementsAre(SizeIs(3), SizeIs(3), SizeIs(3)));
  EXPECT_EQ(asked[0][0].pose, three_blocks[0].pose);
  EXPECT_EQ(asked[1][0].pose, turned);
  EXPECT_EQ(asked[1][2].pose, three_blocks[2].pose);
  EXPECT_EQ(asked[2][0].pose, three_blocks[0].pose);
  EXPECT_EQ(asked[2][2].pose.y, 0.15);
  EXPECT_EQ(record.objects[0].verdict(right_threshold), Verdict::ambiguous);
  EXPECT_EQ(record.objects[1].verdict(right_threshold), Verdict::within);
  EXPECT_EQ(record.objects[2].verdict(right_threshold), Verdict::missed);
  EXPECT_EQ(record.objects[0].verdict({0.01, std::numbers::pi}), Verdict::within);  // 180 degrees: any yaw
}

// --- Summaries
// ------------------------------------------------------------------------------------------------

ObjectRecord object(double translation, double yaw, double visible = 1.0) {
  ObjectRecord record;
  record.model = "block";
  record.visible_fraction = visible;
  record.diameter = 0.1;
  record.errors = PoseErrors{translation, yaw, 0.012, 0.008, 0.012, 22.0, {}};
  record.errors->vsd.fill(0.12);
  return record;
}

/// Two scenes of one method and none of another.
std::vector<MethodRecord> two_methods() {
  SceneRecord first{"a, \"b\"", RunRecord{Status::solved, 3.0, 10, 7, 1.5}, 1, {}};
  first.objects = {object(0.004, 2.0 * degree), object(0.02, 12.0 * degree, 0.3), object(0.5, 3.0, 0.0)};
  first.objects[1].costs = CostComparison{20, 20};
  first.objects[2].confidence = 0.25;
  SceneRecord second{
      "c", RunRecord{Status::time_limit, 1.0, 0, 0, std::nullopt}, 0, {object(0.06, 100.0 * degree)}};
  second.objects[0].symmetric = true;
  second.objects[0].errors->mspd = INFINITY;
  std::vector<MethodRecord> methods{{"one", {first, second}}, {"two", {first, second}}};
  for (SceneRecord& scene : methods[1].scenes) {
    scene.run.reset();
    scene.surplus = 0;
    for (ObjectRecord& missed : scene.objects) missed.errors.reset(), missed.costs.reset();
  }
  return methods;
}

std::vector<MethodSummary> summaries_of(const std::vector<MethodRecord>& methods) {
  std::vector<MethodSummary> summaries;
  for (const MethodRecord& method : methods) summaries.push_back(summarize(method));
  return summaries;
}

TEST(Summary, CountsWhatIsWithinEachThreshold) {
  const MethodSummary summary = summarize(two_methods()[0]);
  // 4 mm and 2 degrees; 20 mm and 12 degrees, ambiguous; 60 mm and 100 degrees; half a metre.
  EXPECT_EQ(summary.thresholds[0][0], (Tally{4, 1, 1}));
  EXPECT_EQ(summary.thresholds[0][3], (Tally{4, 1, 1}));
  EXPECT_EQ(summary.thresholds[1][1], (Tally{4, 1, 1}));
  EXPECT_EQ(summary.thresholds[1][2], (Tally{4, 2, 0}));
  EXPECT_EQ(summary.thresholds[2][2], (Tally{4, 2, 0}));
  EXPECT_EQ(summary.thresholds[2][3], (Tally{4, 3, 0}));
  EXPECT_EQ(summary.right, (Tally{4, 1, 1}));
  EXPECT_EQ(summary.right.missed(), 2U);
  EXPECT_EQ(summary.surplus, 1U);
  EXPECT_EQ(summary.not_found, 0U);
  EXPECT_EQ(summary.mean_seconds, 2.0);
  EXPECT_EQ(summary.median_seconds, 2.0);
  ASSERT_THAT(summary.visibility, SizeIs(5));
  EXPECT_EQ(summary.visibility[0].tally, (Tally{1, 0, 0}));
  EXPECT_EQ(summary.visibility[1].tally, (Tally{1, 0, 1}));
  EXPECT_EQ(summary.visibility[4].tally, (Tally{2, 1, 0}));
}

TEST(Summary, SaysWhatItTook) {
  const MethodSummary summary = summarize(two_methods()[0]);
  EXPECT_EQ(summary.median_rendered, 5.0);
  EXPECT_EQ(summary.mean_expanded, 3.5);
  EXPECT_EQ(summary.bounded, 1U);
  EXPECT_EQ(summary.median_bound, 1.5);
  EXPECT_EQ(summary.largest_bound, 1.5);
  EXPECT_FALSE(summarize(two_methods()[1]).median_bound);
}

TEST(Summary, AveragesRecallsAsBopDoes) {
  const Recalls recalls = summarize(two_methods()[0]).recalls;
  EXPECT_EQ(recalls.add, 0.0);        // 12 mm of 100
  EXPECT_EQ(recalls.add_s, 1.0);      // 8 mm
  EXPECT_EQ(recalls.add_or_s, 0.25);  // one of four is symmetric
  EXPECT_EQ(recalls.ar_mssd, 0.8);    // 12 % of the diameter: below 15 % to 50 %
  EXPECT_EQ(recalls.ar_mspd, 0.45);   // 22 pixels: below 25 to 50 of three; one behind the camera
  EXPECT_EQ(recalls.ar_vsd, 0.8);     // 0.12 at all tau: below 0.15 to 0.5
  EXPECT_DOUBLE_EQ(recalls.ar(), (0.8 + 0.45 + 0.8) / 3.0);
}

TEST(Summary, WithoutResultsNothingIsRecalled) {
  const MethodSummary summary = summarize(two_methods()[1]);
  EXPECT_EQ(summary.right, (Tally{4, 0, 0}));
  EXPECT_EQ(summary.not_found, 4U);
  EXPECT_THAT(summary.without_result, ElementsAre("a, \"b\"", "c"));
  EXPECT_EQ(summary.recalls.ar(), 0.0);
  EXPECT_FALSE(summary.median_seconds);
}

// Wilson's own example is of 10 trials; these are in every table: 8 of 10 lie in [0.490, 0.943].
TEST(Summary, IntervalsAreWilsons) {
  const auto [low, high] = wilson_interval(8, 10);
  EXPECT_NEAR(low, 0.4902, 5e-4);
  EXPECT_NEAR(high, 0.9433, 5e-4);
  EXPECT_NEAR(wilson_interval(10, 10).second, 1.0, 1e-12);
  EXPECT_EQ(wilson_interval(0, 10).first, 0.0);
}

// --- Texts and files
// ------------------------------------------------------------------------------------------

TEST(Tables, SayWhatIsMissing) {
  const std::string text = summary_table(summaries_of(two_methods()));
  EXPECT_THAT(text, HasSubstr("two: no result for 2 of 2 scenes"));
  EXPECT_THAT(object_table(two_methods()), HasSubstr("ambiguous"));
}

TEST(Comparison, RanksScenesFromBestToWorst) {
  const auto scene = [](std::vector<ObjectRecord> objects) {
    return SceneRecord{"s", {}, 0, std::move(objects)};
  };
  ObjectRecord missing = object(0.0, 0.0);
  missing.errors.reset();
  const MethodRecord record{"one",
                            {scene({object(0.004, 0.0), object(0.03, 0.0)}),   // half right
                             scene({object(0.004, 0.0), missing}),             // half right, none at 10 cm
                             scene({object(0.009, 0.0)}),                      // right
                             scene({object(0.002, 0.0), object(0.002, 0.0)}),  // right, and nearer
                             scene({object(0.5, 0.0)}),                        // wrong: 10 cm and no more
                             scene({missing}), scene({object(0.009, 0.0)})}};
  EXPECT_THAT(ranked_scenes(record), ElementsAre(3, 2, 6, 0, 1, 4, 5));
}

TEST(Comparison, ShowsRecallsInPercentAndWhatItTook) {
  auto methods = two_methods();
  methods[1].method = "a|b";
  const std::string tables = comparison_tables(summaries_of(methods));
  EXPECT_THAT(tables, HasSubstr("| of 4 objects, percent within | 1 cm, 5° |"));
  EXPECT_THAT(tables,
              HasSubstr("\n| one | 25.0 | 25.0 | 25.0 | 25.0 | 25.0 | 25.0 | 50.0 | 50.0 | 25.0 | 25.0 | "
                        "50.0 | 75.0 |\n"));
  EXPECT_THAT(tables,
              HasSubstr("\n| one | 2.00 | 2.00 | 5 | 3.5 | 1.500 | 1.500 | 1 of 2 | 1 | 1 | 2 | 0 |\n"));
  EXPECT_THAT(tables, HasSubstr("\n| a\\|b | - | - | - | - | - | - | 0 of 2 | 0 | 0 | 4 | 4 |\n"));
  const std::string page = comparison_page("Words.", summaries_of(methods), {{"p.png", "A picture"}});
  EXPECT_THAT(page, HasSubstr("# Benchmark\n\nWords.\n\n" + tables));
  EXPECT_THAT(page, HasSubstr("![A picture](p.png)"));
}

TEST(Tables, CsvHasALineForEachObjectAndThreshold) {
  const std::string objects = objects_csv(two_methods());
  EXPECT_EQ(std::count(objects.begin(), objects.end(), '\n'), 1 + 8);
  EXPECT_THAT(objects, HasSubstr("\none,\"a, \"\"b\"\"\",1,block,0.3,ambiguous,0.02,"));
  EXPECT_THAT(objects, HasSubstr("\ntwo,c,0,block,1,missed,,,,,,,0.1,1,,,,,"));
  const std::string thresholds = thresholds_csv(summaries_of(two_methods()));
  EXPECT_EQ(std::count(thresholds.begin(), thresholds.end(), '\n'), 1 + 24);
  EXPECT_THAT(thresholds, HasSubstr("\none,0.05,22.5,2,0,2,4\n"));
}

TEST(Tables, JsonHoldsSummariesAndRecords) {
  const auto methods = two_methods();
  const auto json = nlohmann::json::parse(evaluation_json(methods, summaries_of(methods)));
  EXPECT_EQ(json["version"], 1);
  EXPECT_EQ(json["methods"][0]["thresholds"].size(), 12U);
  EXPECT_EQ(json["methods"][0]["right"]["ambiguous"], 1);
  EXPECT_EQ(json["methods"][0]["records"][0]["objects"][1]["costs"]["of_truth"], 20);
  EXPECT_TRUE(json["methods"][0]["records"][1]["objects"][0]["errors"]["mspd_px"].is_null());
  EXPECT_EQ(json["methods"][1]["without_result"].size(), 2U);
  EXPECT_TRUE(json["methods"][1]["records"][0]["run"].is_null());
}

/// gnuplot is part of what the tests need; names from the command line must not be able to hurt.
TEST(Figures, AreDrawnWhateverTheNamesAre) {
  const TemporaryDirectory dir;
  auto methods = two_methods();
  methods[0].method = "it's `touch hurt` @x \\ \"$y\"\n{z}_\xff " + std::string(300, 'W');
  EXPECT_EQ(write_evaluation(dir.path(), methods, summaries_of(methods)), "");
  for (const char* name : {"thresholds.png", "visibility.png"})
    EXPECT_THAT(bytes_of(dir.path() / name), StartsWith("\x89PNG"));
  for (const char* name : {"thresholds.svg", "visibility.svg"})
    EXPECT_THAT(bytes_of(dir.path() / name), HasSubstr("</svg>"));
  for (const char* name : {"evaluation.json", "objects.csv", "thresholds.csv"})
    EXPECT_GT(bytes_of(dir.path() / name).size(), 100U);
  EXPECT_FALSE(std::filesystem::exists("hurt"));
}

TEST(Figures, WithoutGnuplotThereAreTables) {
  const TemporaryDirectory dir;
  dir.write("thresholds.png", "of an earlier run");
  const std::string path = getenv("PATH");
  setenv("PATH", dir.path().c_str(), 1);
  const auto methods = two_methods();
  const std::string message = write_evaluation(dir.path(), methods, summaries_of(methods));
  setenv("PATH", path.c_str(), 1);
  EXPECT_THAT(message, HasSubstr("gnuplot-nox"));
  EXPECT_TRUE(std::filesystem::exists(dir.path() / "objects.csv"));
  EXPECT_FALSE(std::filesystem::exists(dir.path() / "thresholds.png"));
}

TEST(Gnuplot, SaysWhatItFailedOf) {
  try {
    run_gnuplot("plot no_such_function(x)\n");
    FAIL() << "no failure";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no_such_function"));
  }
}

TEST(VisibleFractionsFile, IsReadBesideTheScene) {
  const TemporaryDirectory dir;
  const Scene scene = scene_of(three_blocks);
  const auto read = [&] { return read_visible_fractions(dir.path() / "scene.yaml", scene); };
  EXPECT_EQ(read(), std::nullopt);
  dir.write("truth.json", R"({"names": []})");
  EXPECT_EQ(read(), std::nullopt);
  dir.write("truth.json", R"({"visible": [1, 0.25, 0]})");
  EXPECT_THAT(*read(), ElementsAre(1.0, 0.25, 0.0));
  const std::vector<std::pair<std::string, std::string>> broken{
      {"{", "no JSON"},
      {R"({"visible": 3})", "visible: 3"},
      {R"({"visible": [1, 2, 0]})", "visible[1]: 2 is not from 0 to 1"},
      {R"({"visible": [1, "x", 0]})", "visible[1]"},
      {R"({"visible": [1, 1]})", "visible: has 2 entries, but the scene's truth has 3"}};
  for (const auto& [bytes, words] : broken) {
    dir.write("truth.json", bytes);
    EXPECT_THAT(testing_files::input_error(read), HasSubstr(words)) << bytes;
  }
}

}  // namespace
}  // namespace perch
