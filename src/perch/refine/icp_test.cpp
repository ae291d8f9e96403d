// ICP against known displacements: a body is rendered where it stands, and found again from where it does
// not.

#include "perch/refine/icp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/model/mesh.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

/// A closed upright body over a polygon in the plane.
Mesh prism(const std::vector<Eigen::Vector2f>& outline, float height) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(outline.size());
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();
  for (const auto& p : outline) middle += p / static_cast<float>(n);
  for (const float z : {0.0F, height})
    for (const auto& p : outline) mesh.vertices.emplace_back(p.x(), p.y(), z);
  mesh.vertices.emplace_back(middle.x(), middle.y(), 0.0F);
  mesh.vertices.emplace_back(middle.x(), middle.y(), height);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.push_back({i, j, n + j});
    mesh.triangles.push_back({i, n + j, n + i});
    mesh.triangles.push_back({j, i, 2 * n});
    mesh.triangles.push_back({n + i, n + j, 2 * n + 1});
  }
  return mesh;
}

Mesh wedge() {
  return prism({{-0.05F, -0.03F}, {0.06F, -0.03F}, {0.06F, 0.02F}, {-0.05F, 0.05F}}, 0.12F);
}

Mesh round_can() {
  std::vector<Eigen::Vector2f> outline;
  for (int i = 0; i < 64; ++i)
    outline.emplace_back(0.04F * std::cos(static_cast<float>(i) * 0.0981748F),
                         0.04F * std::sin(static_cast<float>(i) * 0.0981748F));
  return prism(outline, 0.1F);
}

/// Looks down on the origin from 0.8 m.
Camera camera() {
  Camera c;
  c.intrinsics = {320, 240, 400, 400, 159.5, 119.5};
  const double down = 0.6;
  c.world_from_camera.linear().col(0) = Eigen::Vector3d::UnitX();
  c.world_from_camera.linear().col(1) = Eigen::Vector3d(0, -std::sin(down), -std::cos(down));
  c.world_from_camera.linear().col(2) = Eigen::Vector3d(0, std::cos(down), -std::sin(down));
  c.world_from_camera.translation() = Eigen::Vector3d(0, -0.8 * std::cos(down), 0.8 * std::sin(down));
  return c;
}

struct Bench {
  Camera view = camera();
  Rasterizer rasterizer{view.intrinsics};
  RefineSettings settings;
  SerialExecutor executor;

  DepthPatch render(const Mesh& mesh, const Pose& pose) {
    return rasterizer.render(mesh, view.world_from_camera.inverse() * world_from_model(pose, 0.0));
  }
  static DepthImage image_of(const std::vector<const DepthPatch*>& patches, const Intrinsics& k) {
    const DepthPatch all = compose(patches);
    DepthImage image(k.width, k.height);
    for (int v = 0; v < k.height; ++v)
      for (int u = 0; u < k.width; ++u)
        if (all.at_or_none(u, v) < no_surface) image(u, v) = all.at_or_none(u, v);
    return image;
  }
  Pose refine(const Mesh& mesh, Pose pose, bool fix_yaw, const Observation& observation,
              const NearestTable& table, double reach) {
    for (int round = 0; round < 3; ++round) {
      std::vector<SurfaceSample> samples;
      const DepthPatch patch = render(mesh, pose);
      sample_patch(patch, nullptr, observation, settings, samples);
      pose = align(samples, pose, fix_yaw, table, reach, settings);
    }
    return pose;
  }
};

TEST(IcpHeavy, FindsABodyAgain) {
  Bench bench;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Pose truth{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-3, 3)};
    const DepthPatch seen = bench.render(wedge(), truth);
    const Observation observation(bench.view, Bench::image_of({&seen}, bench.view.intrinsics), std::nullopt);
    const NearestTable table(observation, 0.03, bench.executor);
    const Pose start{truth.x + random.uniform(-0.01, 0.01), truth.y + random.uniform(-0.01, 0.01),
                     truth.yaw + random.uniform(-0.12, 0.12)};
    const Pose found = bench.refine(wedge(), start, false, observation, table, 0.03);
    EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.002);
    EXPECT_LT(std::abs(found.yaw - truth.yaw), 0.03);
  }
}

TEST(Icp, LeavesTheYawOfASolidOfRevolution) {
  Bench bench;
  const Pose truth{0.02, 0.01, 0.0};
  const DepthPatch seen = bench.render(round_can(), truth);
  const Observation observation(bench.view, Bench::image_of({&seen}, bench.view.intrinsics), std::nullopt);
  const NearestTable table(observation, 0.03, bench.executor);
  const Pose found = bench.refine(round_can(), {0.035, 0.0, 0.0}, true, observation, table, 0.03);
  EXPECT_EQ(found.yaw, 0.0);
  EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.002);
}

// The share of the samples that find a point of I decides whether anything is moved, from where on is what
// counting says.
TEST(Icp, LeavesWhatTooFewSamplesFindAPointFor) {
  Bench bench;
  const DepthPatch seen = bench.render(wedge(), {0.0, 0.0, 0.0});
  const Observation observation(bench.view, Bench::image_of({&seen}, bench.view.intrinsics), std::nullopt);
  constexpr double reach = 0.02;
  const NearestTable table(observation, reach, bench.executor);
  int moved = 0, left = 0;
  for (int step = 0; step <= 12; ++step) {
    const Pose pose{0.012 * step, 0.0, 0.0};
    std::vector<SurfaceSample> samples;
    sample_patch(bench.render(wedge(), pose), nullptr, observation, bench.settings, samples);
    const auto matched =
        static_cast<double>(std::count_if(samples.begin(), samples.end(), [&](const SurfaceSample& sample) {
          const Eigen::Vector3f* q = table.lookup(sample.point);
          return q != nullptr && (sample.point - *q).norm() <= static_cast<float>(reach);
        }));
    for (const double least : {0.1, 0.3, 0.9}) {
      SCOPED_TRACE(testing::Message() << "step " << step << ", least " << least);
      bench.settings.least_matched = least;
      const bool enough = matched > 0.0 && matched >= least * static_cast<double>(samples.size());
      const Pose found = align(samples, pose, false, table, reach, bench.settings);
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
  Bench bench;
  const Pose truth{0.0, 0.1, 0.3};
  const DepthPatch behind = bench.render(wedge(), truth),
                   front = bench.render(round_can(), {0.045, -0.05, 0.0});
  const Observation observation(bench.view, Bench::image_of({&behind, &front}, bench.view.intrinsics),
                                std::nullopt);
  std::vector<SurfaceSample> samples;
  sample_patch(behind, nullptr, observation, bench.settings, samples);
  ASSERT_FALSE(samples.empty());
  const Eigen::Isometry3f camera_from_world = bench.view.world_from_camera.inverse().cast<float>();
  for (const SurfaceSample& s : samples) {
    EXPECT_NEAR(s.normal.norm(), 1.0F, 1e-4F);
    const Eigen::Vector3f p = camera_from_world * s.point;
    const int u = static_cast<int>(std::lround(p.x() / p.z() * 400.0F + 159.5F)),
              v = static_cast<int>(std::lround(p.y() / p.z() * 400.0F + 119.5F));
    EXPECT_LT(p.z() - observation.depth(u, v), 0.021F);
    EXPECT_LT(s.normal.dot(bench.view.world_from_camera.linear().cast<float>() * p), 0.0F)
        << "turned to the camera";
  }
  const NearestTable table(observation, 0.02, bench.executor);
  const Pose found = bench.refine(wedge(), {0.008, 0.106, 0.36}, false, observation, table, 0.02);
  EXPECT_LT(std::hypot(found.x - truth.x, found.y - truth.y), 0.003);
  EXPECT_LT(std::abs(found.yaw - truth.yaw), 0.04);
}

TEST(Icp, SamplesTheSameOfARenderingOfTheSampledPixelsOnly) {
  Bench bench;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Pose pose{random.uniform(-0.3, 0.3), random.uniform(-0.1, 0.1), random.uniform(-3, 3)};
    const DepthPatch seen = bench.render(wedge(), {0.0, 0.0, 0.4}), patch = bench.render(wedge(), pose);
    const DepthPatch in_front = bench.render(round_can(), {pose.x + 0.02, pose.y - 0.09, 0.0});
    const Observation observation(bench.view, Bench::image_of({&seen}, bench.view.intrinsics), std::nullopt);
    bench.settings.samples = 100;
    DepthCrosses crosses;
    DepthPatch whole;
    if (!bench.rasterizer.render_samples(wedge(),
                                         bench.view.world_from_camera.inverse() * world_from_model(pose, 0.0),
                                         bench.settings.samples, crosses, whole))
      continue;
    for (const DepthPatch* front : {static_cast<const DepthPatch*>(nullptr), &in_front}) {
      std::vector<SurfaceSample> expected, found;
      sample_patch(patch, front, observation, bench.settings, expected);
      sample_crosses(crosses, front, observation, bench.settings, found);
      ASSERT_EQ(found.size(), expected.size());
      if (front == nullptr) {
        EXPECT_GT(found.size(), 20U);
      }
      for (std::size_t i = 0; i < found.size(); ++i) {
        EXPECT_EQ(found[i].point, expected[i].point);
        EXPECT_EQ(found[i].normal, expected[i].normal);
      }
    }
  }
}

TEST(Icp, StaysWhereNothingIsNear) {
  Bench bench;
  const DepthPatch seen = bench.render(wedge(), {-0.15, 0.0, 0.0});
  const Observation observation(bench.view, Bench::image_of({&seen}, bench.view.intrinsics), std::nullopt);
  const NearestTable table(observation, 0.02, bench.executor);
  const Pose start{0.15, 0.0, 0.5};
  EXPECT_EQ(bench.refine(wedge(), start, false, observation, table, 0.02), start);
  EXPECT_EQ(align({}, start, false, table, 0.02, bench.settings), start);
}

// Samples pushed off a body along their normals lie that far from it.
TEST(MeanResidual, MeasuresAlongTheNormals) {
  Bench bench;
  const DepthPatch seen = bench.render(wedge(), {0.01, 0.02, 0.4});
  const Observation observation(bench.view, Bench::image_of({&seen}, bench.view.intrinsics), std::nullopt);
  const NearestTable table(observation, 0.02, bench.executor);
  std::vector<SurfaceSample> samples;
  sample_patch(seen, nullptr, observation, bench.settings, samples);
  ASSERT_GT(samples.size(), 100U);
  constexpr double limit = 0.005;
  for (const double shift : {0.0, 0.001, 0.002, -0.003, 0.004}) {
    std::vector<SurfaceSample> moved = samples;
    for (SurfaceSample& s : moved) s.point += static_cast<float>(shift) * s.normal;
    EXPECT_NEAR(mean_residual(moved, table, limit), std::abs(shift) / limit, 0.03) << shift;
  }
  for (SurfaceSample& s : samples) s.point.x() += 0.5F;
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
