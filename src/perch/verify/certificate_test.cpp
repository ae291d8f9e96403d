#include "perch/verify/certificate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace perch {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Two mugs and a can, and perhaps a box.
Scene scene() {
  Scene scene;
  scene.models.resize(3);
  scene.models[0].name = "mug";
  scene.models[1].name = "can";
  scene.models[2].name = "box";
  scene.objects = {0, 1, 0, {2, true}};
  return scene;
}

ReportedResult solved() {
  ReportedResult r;
  r.status = Status::solved;
  r.cost = 812;
  r.cost_observed = 400;
  r.cost_rendered = 412;
  r.observed_points = 3000;
  r.search_cost = 830;
  r.lower_bound = 640;
  r.suboptimality_bound = 830.0 / 640.0;
  r.guarantee.w = 3.0;
  r.search_objects = {{0, {}}, {0, {}}, {1, {}}};
  r.objects.resize(4);
  r.objects[1].model = 1;
  r.objects[3].model = 2;
  r.objects[3].absent = true;
  return r;
}

ReportedResult without_scene(Status status) {
  ReportedResult r;
  r.status = status;
  r.observed_points = 3000;
  return r;
}

std::vector<std::string> wrong(const ReportedResult& result) {
  Checks checks;
  check_certificate(scene(), result, checks);
  EXPECT_FALSE(checks.empty());
  std::vector<std::string> names;
  for (const Check& check : checks)
    if (!check.holds) names.push_back(check.name);
  return names;
}

TEST(Certificate, OfAGoodResultHolds) {
  EXPECT_THAT(wrong(solved()), IsEmpty());
  EXPECT_THAT(wrong(without_scene(Status::infeasible)), IsEmpty());
  EXPECT_THAT(wrong(without_scene(Status::time_limit)), IsEmpty());
}

TEST(Certificate, UnprovenIsATimeLimit) {
  ReportedResult r = solved();
  r.lower_bound = 276;  // 3 x 276 = 828
  r.suboptimality_bound = 830.0 / 276.0;
  r.status = Status::time_limit;
  EXPECT_THAT(wrong(r), IsEmpty());
  r.status = Status::solved;
  EXPECT_THAT(wrong(r), ElementsAre("status"));
}

TEST(Certificate, NoCostAndNoBoundIsOptimal) {
  ReportedResult r = solved();
  r.cost = r.cost_observed = r.cost_rendered = r.search_cost = 0;
  r.lower_bound = 0;
  r.suboptimality_bound = 1.0;
  EXPECT_THAT(wrong(r), IsEmpty());
  r.suboptimality_bound.reset();
  EXPECT_THAT(wrong(r), ElementsAre("suboptimality_bound"));
}

TEST(Certificate, WithoutABoundThereIsNoFactor) {
  ReportedResult r = solved();
  r.lower_bound = 0;
  r.suboptimality_bound.reset();
  r.status = Status::time_limit;
  EXPECT_THAT(wrong(r), IsEmpty());
  r.suboptimality_bound = 830.0;
  EXPECT_THAT(wrong(r), ElementsAre("suboptimality_bound"));
}

struct Fault {
  const char* what;
  std::function<void(ReportedResult&)> make;
  std::vector<std::string> wrong;
};

class CertificateFault : public testing::TestWithParam<Fault> {};
TEST_P(CertificateFault, IsFound) {
  ReportedResult r = solved();
  GetParam().make(r);
  EXPECT_EQ(wrong(r), GetParam().wrong);
}
INSTANTIATE_TEST_SUITE_P(
    Each, CertificateFault,
    testing::Values(
        Fault{"sum", [](auto& r) { r.cost_observed = 401; }, {"cost = cost_observed + cost_rendered"}},
        Fault{"cost above search_cost",
              [](auto& r) {
                r.cost = 831;
                r.cost_observed = 419;
              },
              {"cost <= search_cost"}},
        Fault{"bound above search_cost",
              [](auto& r) {
                r.lower_bound = 831;
                r.suboptimality_bound = 830.0 / 831.0;
              },
              {"lower_bound <= search_cost"}},
        Fault{
            "factor", [](auto& r) { r.suboptimality_bound = 830.0 / 640.0 + 1e-9; }, {"suboptimality_bound"}},
        Fault{"no factor", [](auto& r) { r.suboptimality_bound.reset(); }, {"suboptimality_bound"}},
        Fault{"not called solved", [](auto& r) { r.status = Status::time_limit; }, {"status"}},
        Fault{"called infeasible", [](auto& r) { r.status = Status::infeasible; }, {"status"}},
        Fault{"w below 1",
              [](auto& r) {
                r.guarantee.w = 0.99;
                r.status = Status::time_limit;
              },
              {"guarantee.w"}},
        Fault{"negative count", [](auto& r) { r.stats.expanded = -1; }, {"counts"}},
        Fault{"negative pixels", [](auto& r) { r.objects[2].visible_pixels = -1; }, {"counts"}},
        Fault{"no cost",
              [](auto& r) { r.cost.reset(); },
              {"cost = cost_observed + cost_rendered", "cost <= search_cost"}},
        Fault{"no search cost",
              [](auto& r) { r.search_cost.reset(); },
              {"cost <= search_cost", "lower_bound <= search_cost", "suboptimality_bound", "status"}},
        Fault{"order",
              [](auto& r) { std::swap(r.objects[0].model, r.objects[1].model); },
              {"objects[0].model", "objects[1].model"}},
        Fault{"one too few", [](auto& r) { r.objects.pop_back(); }, {"objects, how many"}},
        Fault{"one too many", [](auto& r) { r.objects.push_back(r.objects[1]); }, {"objects, how many"}},
        Fault{"another model", [](auto& r) { r.search_objects[2].model = 2; }, {"search_objects: can"}},
        Fault{
            "a required object is absent", [](auto& r) { r.objects[1].absent = true; }, {"objects[1].model"}},
        Fault{"search objects missing",
              [](auto& r) { r.search_objects.clear(); },
              {"search_objects: mug", "search_objects: can"}}),
    [](const auto& fault) {
      std::string name = fault.param.what;
      std::replace(name.begin(), name.end(), ' ', '_');
      return name;
    });

TEST(Certificate, OptionalObjectsMayBeThere) {
  ReportedResult r = solved();
  r.objects[3].absent = false;
  EXPECT_THAT(wrong(r), IsEmpty());
  r.search_objects.push_back({2, {}});
  EXPECT_THAT(wrong(r), IsEmpty());
  r.search_objects.push_back({2, {}});
  EXPECT_THAT(wrong(r), ElementsAre("search_objects: box"));
}

TEST(Certificate, SolvedNeedsAScene) {
  EXPECT_THAT(wrong(without_scene(Status::solved)), ElementsAre("status"));
  ReportedResult r = without_scene(Status::infeasible);
  r.cost_observed = 5;
  EXPECT_THAT(wrong(r), testing::Contains("cost = cost_observed + cost_rendered"));
}

}  // namespace
}  // namespace perch
