#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "perch/eval/comparison.hpp"
#include "perch/eval/figures.hpp"
#include "perch/eval/gnuplot.hpp"
#include "perch/eval/report.hpp"
#include "perch/eval/summary.hpp"
#include "perch/eval/tables.hpp"
#include "perch/io/test_files.hpp"

// What is made of the records of many scenes: summaries, tables, figures, files.
namespace perch {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;
using testing_files::bytes_of;
using testing_files::TemporaryDirectory;

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
  first.objects = {object(0.004, degrees(2.0)), object(0.02, degrees(12.0), 0.3), object(0.5, 3.0, 0.0)};
  first.objects[1].costs = CostComparison{20, 20};
  first.objects[2].confidence = 0.25;
  SceneRecord second{
      "c", RunRecord{Status::time_limit, 1.0, 0, 0, std::nullopt}, 0, {object(0.06, degrees(100.0))}};
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

}  // namespace
}  // namespace perch
