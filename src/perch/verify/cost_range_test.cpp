#include "perch/verify/cost_range.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "perch/verify/test_shapes.hpp"

namespace perch {
namespace {

using testing_verify::box;
using testing_verify::clutter;
using testing_verify::random_pose;
using testing_verify::sphere;

const Eigen::Isometry3d at_origin = Eigen::Isometry3d::Identity();

struct Object {
  Mesh mesh;
  Eigen::Isometry3d camera_from_model;
};

SceneView view_of(const std::vector<Object>& objects, const Intrinsics& k) {
  std::vector<Sighting> all;
  for (std::uint32_t i = 0; i < objects.size(); ++i) {
    const auto seen = sightings(objects[i].mesh, objects[i].camera_from_model, k, i);
    all.insert(all.end(), seen.begin(), seen.end());
  }
  return {std::move(all), objects.size()};
}

/// A camera that looks straight down from 1 m at a box of 0.2 x 0.1 m and 0.1 m height: its top, at 0.9 m,
/// covers the pixels with |u - 40| <= 22 and |v - 30| <= 11 and hides its sides.
class BoxFromAbove : public testing::Test {
 protected:
  const Intrinsics k{80, 60, 200.0, 200.0, 40.0, 30.0};
  const double top = 0.9;
  const std::int64_t covered = 45 * 23;

  SceneView view() const {
    Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
    camera_from_model.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    camera_from_model.translation() << 0.0, 0.0, 1.0;
    return view_of({{box({-0.1F, -0.05F, 0.0F}, {0.2F, 0.1F, 0.1F}), camera_from_model}}, k);
  }

  /// What would be seen of the top if it stood `shift` columns to the right, `offset` metres farther away.
  DepthImage shifted(int shift, double offset) const {
    DepthImage depth(80, 60, 0.0F);
    for (int v = 30 - 11; v <= 30 + 11; ++v)
      for (int u = 40 - 22; u <= 40 + 22; ++u)
        if (depth.contains(u + shift, v)) depth(u + shift, v) = static_cast<float>(top + offset);
    return depth;
  }

  CostRange cost(const DepthImage& depth, double delta, bool ignore_missing = false,
                 const std::optional<Image<std::uint8_t>>& mask = {}) const {
    return cost_range(ObservedPoints({k, at_origin}, depth, mask), k, view(),
                      {delta, ignore_missing, false, {}});
  }
};

TEST_F(BoxFromAbove, ThereIsNoCostWhereItIs) {
  const CostRange c = cost(shifted(0, 0.0), 0.001);
  EXPECT_EQ(c.total(), (CountRange{0, 0}));
  EXPECT_EQ(c.explained, (std::vector<CountRange>{{covered, covered}}));
  EXPECT_EQ(view().visible(), (std::vector<CountRange>{{covered, covered}}));
  EXPECT_EQ(view().alone(), (std::vector<CountRange>{{covered, covered}}));
}

// A pixel is 4.5 mm wide at 0.9 m. With a smaller delta each pixel explains itself alone; with delta = 10 mm
// the two columns next to the common part are explained too.
TEST_F(BoxFromAbove, ColumnsThatStickOutCount) {
  for (const int shift : {1, 3, 10, 17}) {
    const std::int64_t out = 23 * shift;
    const CostRange narrow = cost(shifted(shift, 0.0), 0.001);
    EXPECT_EQ(narrow.observed, (CountRange{out, out})) << shift;
    EXPECT_EQ(narrow.rendered, (CountRange{out, out})) << shift;
    const std::int64_t left = 23 * std::max(0, shift - 2);
    const CostRange wide = cost(shifted(shift, 0.0), 0.010);
    EXPECT_EQ(wide.observed, (CountRange{left, left})) << shift;
    EXPECT_EQ(wide.rendered, (CountRange{left, left})) << shift;
  }
}

TEST_F(BoxFromAbove, DepthIsMeasuredAgainstDelta) {
  EXPECT_EQ(cost(shifted(0, 0.0049), 0.005).total(), (CountRange{0, 0}));
  const CostRange beyond = cost(shifted(0, 0.0052), 0.005);  // rays spread: 0.01 mm more off the axis
  EXPECT_EQ(beyond.observed, (CountRange{covered, covered}));
  EXPECT_EQ(beyond.rendered, (CountRange{covered, covered}));
  EXPECT_EQ(beyond.explained, (std::vector<CountRange>{{0, 0}}));
  // Pairs that are exactly delta apart may fall on either side.
  const double exact = static_cast<float>(top + 0.005) - static_cast<double>(static_cast<float>(top));
  const CostRange on_it = cost(shifted(0, 0.005), exact);
  EXPECT_LT(on_it.observed.low, covered);
  EXPECT_EQ(on_it.observed.high, covered);
}

TEST_F(BoxFromAbove, MissingDepthCountsOrIsLeftOut) {
  DepthImage depth = shifted(0, 0.0);
  Image<std::uint8_t> mask(80, 60, 1);
  for (int v = 20; v < 25; ++v) depth(35, v) = 0.0F;  // no reading: unknown
  for (int v = 20; v < 27; ++v) mask(50, v) = 0;      // a reading that is no object's: free
  const CostRange counted = cost(depth, 0.001, false, mask), ignored = cost(depth, 0.001, true, mask);
  EXPECT_EQ(counted.rendered, (CountRange{12, 12}));
  EXPECT_EQ(ignored.rendered, (CountRange{7, 7}));
  EXPECT_EQ(ignored.observed, (CountRange{0, 0}));
  // Without a mask the background was removed from the depth itself: every such pixel is free.
  EXPECT_EQ(cost(depth, 0.001, true).rendered, (CountRange{5, 5}));
}

/// J by comparing all with all. \param z depths of R, 0 = nothing.
struct BruteForce {
  std::int64_t observed = 0, rendered = 0;
};
BruteForce brute_force(const std::vector<Eigen::Vector3d>& observed, const Intrinsics& k,
                       const Image<double>& z, double delta) {
  std::vector<Eigen::Vector3d> rendered;
  for (std::uint32_t i = 0; i < z.size(); ++i)
    if (z[i] > 0.0) rendered.push_back(point_at(k, i, z[i]));
  BruteForce result;
  const auto unexplained = [&](const auto& cloud, const auto& by) {
    std::int64_t count = 0;
    for (const Eigen::Vector3d& p : cloud) {
      bool near = false;
      for (const Eigen::Vector3d& q : by) near = near || (p - q).norm() <= delta;
      count += !near;
    }
    return count;
  };
  result.observed = unexplained(observed, rendered);
  result.rendered = unexplained(rendered, observed);
  return result;
}

TEST(CostRange, HoldsTheBruteForceCount) {
  const Intrinsics k{60, 45, 60.0, 61.0, 29.6, 21.8};
  std::int64_t width = 0, total = 0;
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    Random random(seed);
    const auto place = [&] {
      return random_pose(random,
                         {random.uniform(-0.1, 0.1), random.uniform(-0.06, 0.06), random.uniform(0.25, 0.4)});
    };
    const std::vector<Object> objects{{sphere(0.04, 8), place()},
                                      {box({-0.03F, -0.02F, -0.05F}, {0.06F, 0.04F, 0.1F}), place()},
                                      {clutter(random, 20), place()}};
    const SceneView view = view_of(objects, k);
    // The view's own middle depths are the truth here; that they hold the exact depths is tested elsewhere.
    Image<double> z(k.width, k.height, 0.0);
    DepthImage depth(k.width, k.height, 0.0F);
    for (const SeenPixel& pixel : view.pixels()) {
      const DepthRange seen = view.seen(pixel).front().depth;
      z[pixel.pixel] = 0.5 * (seen.near + seen.far);
    }
    const double delta = random.uniform(0.002, 0.02);
    for (std::size_t i = 0; i < depth.size(); ++i)
      if (z[i] > 0.0 && random.uniform() < 0.8) depth[i] = static_cast<float>(z[i] + 0.01 * random.normal());
    const ObservedPoints observed({k, at_origin}, depth, {});
    const BruteForce truth = brute_force(observed.points(), k, z, delta);
    const CostRange cost = cost_range(observed, k, view, {delta, false, false, {}});
    EXPECT_TRUE(cost.observed.contains(truth.observed)) << truth.observed << ", not " << cost.observed.text();
    EXPECT_TRUE(cost.rendered.contains(truth.rendered)) << truth.rendered << ", not " << cost.rendered.text();
    width += cost.total().width();
    total += truth.observed + truth.rendered;
  }
  EXPECT_GT(total, 1000);
  EXPECT_LT(width, total / 50);
}

// A wall seen edge-on may be rendered at any depth from 0.5 m to 1 m, or not at all. So a point near its
// front end may be explained or not, and so may the rendered point; one that is farther away is not.
TEST(CostRange, WhatMayBeRenderedMayExplain) {
  const Intrinsics k{40, 30, 100.0, 100.0, 20.0, 15.0};
  Mesh wall;
  wall.vertices = {{0.0F, -0.001F, 0.5F}, {0.0F, 0.001F, 0.5F}, {0.0F, 0.001F, 1.0F}, {0.0F, -0.001F, 1.0F}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const SceneView view = view_of({{wall, at_origin}}, k);
  ASSERT_EQ(view.pixels().size(), 1U);
  const double delta = 0.01;
  for (const double beyond : {0.97, 1.03}) {
    DepthImage depth(40, 30, 0.0F);
    depth(20, 15) = static_cast<float>(0.5 - beyond * delta);
    const CostRange cost =
        cost_range(ObservedPoints({k, at_origin}, depth, {}), k, view, {delta, false, false, {}});
    EXPECT_EQ(cost.observed, (CountRange{beyond > 1.0, 1})) << beyond;
    EXPECT_EQ(cost.rendered, (CountRange{0, 1})) << beyond;
    EXPECT_EQ(cost.explained, (std::vector<CountRange>{{0, beyond < 1.0}})) << beyond;
  }
}

TEST(SceneView, TheNearestObjectIsSeen) {
  const Intrinsics k{80, 60, 100.0, 100.0, 39.7, 29.7};
  const Eigen::Isometry3d near(Eigen::Translation3d(0.0, 0.0, 0.5)), far(Eigen::Translation3d(0.0, 0.0, 1.0));
  const Mesh small = box({-0.05F, -0.05F, 0.0F}, {0.1F, 0.1F, 0.1F}),
             large = box({-0.2F, -0.2F, 0.0F}, {0.4F, 0.4F, 0.1F});
  const SceneView view = view_of({{large, far}, {small, near}}, k);
  EXPECT_EQ(view.alone()[0], (CountRange{40 * 40, 40 * 40}));
  EXPECT_EQ(view.visible()[1], (CountRange{20 * 20, 20 * 20}));
  EXPECT_EQ(view.visible()[0], (CountRange{40 * 40 - 20 * 20, 40 * 40 - 20 * 20}));
  for (const SeenPixel& pixel : view.pixels()) EXPECT_EQ(view.seen(pixel).size(), 1U);
}

TEST(SceneView, OfTwoAtOnePlaceEitherMayBeSeen) {
  const Intrinsics k{80, 60, 100.0, 100.0, 39.7, 29.7};
  const Eigen::Isometry3d pose(Eigen::Translation3d(0.0, 0.0, 0.5));
  const Mesh mesh = box({-0.05F, -0.05F, 0.0F}, {0.1F, 0.1F, 0.1F});
  const SceneView view = view_of({{mesh, pose}, {mesh, pose}}, k);
  for (const CountRange& visible : view.visible()) EXPECT_EQ(visible, (CountRange{0, 400}));
  for (const SeenPixel& pixel : view.pixels()) EXPECT_FALSE(pixel.may_miss);
}

}  // namespace
}  // namespace perch
