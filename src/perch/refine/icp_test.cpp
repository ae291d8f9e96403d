// ICP against known displacements: a body is rendered where it stands, and found again from where it does
// not.

#include "perch/refine/icp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"
#include "perch/refine/icp_test_support.hpp"

namespace perch {
namespace {

TEST(IcpHeavy, FindsABodyAgain) {
  RefineBench bench;
  const ObjectModel body = object(wedge());
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Pose truth{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-3, 3)};
    const Observation observation = bench.observe(bench.render(wedge(), truth));
    const NearestTable table(observation, 0.03, bench.executor);
    const Pose start{truth.x + random.uniform(-0.01, 0.01), truth.y + random.uniform(-0.01, 0.01),
                     truth.yaw + random.uniform(-0.12, 0.12)};
    const Pose found = bench.refine(body, start, observation, table, 0.03);
    EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.002);
    EXPECT_LT(std::abs(found.yaw - truth.yaw), 0.03);
  }
}

TEST(Icp, LeavesTheYawOfASolidOfRevolution) {
  RefineBench bench;
  const Pose truth{0.02, 0.01, 0.0};
  const Observation observation = bench.observe(bench.render(round_can(), truth));
  const NearestTable table(observation, 0.03, bench.executor);
  const Pose found =
      bench.refine(object(round_can(), Symmetry::continuous()), {0.035, 0.0, 0.0}, observation, table, 0.03);
  EXPECT_EQ(found.yaw, 0.0);
  EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.002);
}

// The share of the samples that find a point of I decides whether anything is moved, from where on is what
// counting says.
TEST(Icp, LeavesWhatTooFewSamplesFindAPointFor) {
  RefineBench bench;
  const ObjectModel body = object(wedge());
  const SurfaceViews views = bench.views(body);
  const Observation observation = bench.observe(bench.render(wedge(), {0.0, 0.0, 0.0}));
  constexpr double reach = 0.02;
  const NearestTable table(observation, reach, bench.executor);
  int moved = 0, left = 0;
  for (int step = 0; step <= 12; ++step) {
    const Pose pose{0.012 * step, 0.0, 0.0};
    const SurfaceSamples samples = bench.samples(views, body, pose, observation);
    int matched = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector3f* q = table.lookup(samples.point(i));
      matched += q != nullptr && (samples.point(i) - *q).norm() <= static_cast<float>(reach);
    }
    for (const double least : {0.1, 0.3, 0.9}) {
      SCOPED_TRACE(testing::Message() << "step " << step << ", least " << least);
      bench.settings.least_matched = least;
      const bool enough = matched > 0 && matched >= least * static_cast<double>(samples.size());
      const Pose found = align(samples, pose, false, table, reach, bench.settings).pose;
      EXPECT_EQ(found == pose, !enough);
      ++(enough ? moved : left);
    }
  }
  EXPECT_GT(moved, 5);
  EXPECT_GT(left, 5);
}

// What the observation shows to be hidden takes no part: a body half behind another is not pulled onto that
// one.
TEST(Icp, LeavesOutHiddenPoints) {
  RefineBench bench;
  const ObjectModel body = object(wedge());
  const Pose truth{0.0, 0.1, 0.3};
  const DepthPatch behind = bench.render(wedge(), truth),
                   front = bench.render(round_can(), {0.045, -0.05, 0.0});
  const Observation alone = bench.observe(behind), observation = bench.observe({&behind, &front});
  const SurfaceViews views = bench.views(body);
  const SurfaceSamples samples = bench.samples(views, body, truth, observation);
  ASSERT_FALSE(samples.empty());
  EXPECT_LT(samples.size(), bench.samples(views, body, truth, alone).size());
  const Eigen::Isometry3f camera_from_world = bench.camera.world_from_camera.inverse().cast<float>();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(samples.normal(i).norm(), 1.0F, 1e-4F);
    const Eigen::Vector3f p = camera_from_world * samples.point(i);
    const int u = static_cast<int>(std::lround(p.x() / p.z() * 400.0F + 159.5F)),
              v = static_cast<int>(std::lround(p.y() / p.z() * 400.0F + 119.5F));
    const float observed = observation.depth(u, v);
    if (observed > 0.0F) {
      EXPECT_LT(p.z() - observed, 0.021F);
    }
  }
  const NearestTable table(observation, 0.02, bench.executor);
  const Pose found = bench.refine(body, {0.008, 0.106, 0.36}, observation, table, 0.02);
  EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.003);
  EXPECT_LT(std::abs(found.yaw - truth.yaw), 0.04);
}

TEST(Icp, StaysWhereNothingIsNear) {
  RefineBench bench;
  const Observation observation = bench.observe(bench.render(wedge(), {-0.15, 0.0, 0.0}));
  const NearestTable table(observation, 0.02, bench.executor);
  const Pose start{0.15, 0.0, 0.5};
  EXPECT_EQ(bench.refine(object(wedge()), start, observation, table, 0.02), start);
  EXPECT_EQ(align({}, start, false, table, 0.02, bench.settings), (Alignment{start, 1.0}));
}

// Samples pushed off a body along their normals lie that far from it.
TEST(MeanResidual, MeasuresAlongTheNormals) {
  RefineBench bench;
  const ObjectModel body = object(wedge());
  const Pose pose{0.01, 0.02, 0.4};
  const Observation observation = bench.observe(bench.render(wedge(), pose));
  const NearestTable table(observation, 0.02, bench.executor);
  SurfaceSamples samples = bench.samples(bench.views(body), body, pose, observation);
  ASSERT_GT(samples.size(), 100U);
  constexpr double limit = 0.005;
  for (const double shift : {0.0, 0.001, 0.002, -0.003, 0.004}) {
    SurfaceSamples moved;
    for (std::size_t i = 0; i < samples.size(); ++i)
      moved.push_back(samples.point(i) + static_cast<float>(shift) * samples.normal(i), samples.normal(i));
    EXPECT_NEAR(mean_residual(moved, table, limit), std::abs(shift) / limit, 0.03) << shift;
  }
  for (float& x : samples.x) x += 0.5F;
  EXPECT_EQ(mean_residual(samples, table, limit), 1.0) << "nothing is near";
  EXPECT_EQ(mean_residual({}, table, limit), 1.0);
}

TEST(RefineSettings, ChecksItsFields) {
  RefineSettings s;
  EXPECT_NO_THROW(s.check());
  s.reach = -1.0;
  EXPECT_THROW(s.check(), InvalidSetting);
  s = {};
  s.rounds = 0;
  EXPECT_THROW(s.check(), InvalidSetting);
  s = {};
  s.robust_scale = std::nan("");
  EXPECT_THROW(s.check(), InvalidSetting);
}

}  // namespace
}  // namespace perch
