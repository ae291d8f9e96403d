#include "perch/sim/ground_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "perch/core/random.hpp"
#include "perch/model/surface_samples.hpp"
#include "perch/sim/footprint.hpp"
#include "perch/sim/mesh_builder.hpp"
#include "perch/sim/model_catalogue.hpp"

namespace perch {
namespace {

TEST(GroundPlan, OfBoxesKeepsTheGap) {
  const GroundPlan plan(box({0.1, 0.06, 0.1}, 0.02), 0.005);
  for (const double yaw : {0.0, 0.4, 2.0}) {
    const auto beside = [&](double distance) {
      return Pose{(0.1 + distance) * std::cos(yaw), (0.1 + distance) * std::sin(yaw), yaw};
    };
    EXPECT_FALSE(apart(plan, {0, 0, yaw}, plan, beside(0.0049)));
    EXPECT_TRUE(apart(plan, {0, 0, yaw}, plan, beside(0.0094)));
    EXPECT_FALSE(apart(plan, {0, 0, yaw}, plan, {0.01, 0, yaw})) << "nearly the same place";
  }
  const GroundPlan small(box({0.01, 0.01, 0.1}, 0.02), 0.005);
  EXPECT_FALSE(apart(plan, {0, 0, 0}, small, {0, 0, 0.3})) << "one within the other";
  EXPECT_FALSE(apart(small, {0, 0, 0}, plan, {0, 0, 0.3}));
}

TEST(GroundPlan, LetsThingsStandBesideAHandleWhereHullsOverlap) {
  const Mesh pan = named_model("saucepan").mesh, cup = named_model("spice_jar").mesh;
  const Pose beside{0.14, 0.045, 0.0};
  EXPECT_EQ(gap(Footprint(pan), Footprint(cup).at(beside)), 0.0);
  EXPECT_TRUE(apart(GroundPlan(pan, 0.005), {}, GroundPlan(cup, 0.005), beside));
}

/// Points of the surface, z left out, one a cell of the spacing.
std::vector<Eigen::Vector3d> seen_from_above(const Mesh& mesh, float spacing) {
  std::map<std::pair<long, long>, Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : sample_surface(mesh, spacing))
    points.try_emplace({std::lround(p.x() / spacing), std::lround(p.y() / spacing)}, p.x(), p.y(), 0.0);
  std::vector<Eigen::Vector3d> out;
  for (const auto& [cell, point] : points) out.push_back(point);
  return out;
}

TEST(GroundPlan, AgreesWithPointsOnTheSurfaces) {
  constexpr double reach = 0.005, error = 0.0043;
  constexpr float spacing = 0.002F;
  const Mesh jug = named_model("jug").mesh, drill = named_model("drill").mesh;
  const GroundPlan jug_plan(jug, reach), drill_plan(drill, reach);
  const auto jug_points = seen_from_above(jug, spacing), drill_points = seen_from_above(drill, spacing);
  Random random(11);
  int near = 0, far = 0;
  for (int i = 0; i < 12; ++i) {
    const Pose a{0, 0, random.uniform(-3, 3)},
        b{random.uniform(0.08, 0.2), random.uniform(-0.05, 0.05), random.uniform(-3, 3)};
    double least = std::numeric_limits<double>::infinity();
    const Eigen::Isometry3d a_from_b = world_from_model(a, 0).inverse() * world_from_model(b, 0);
    for (const Eigen::Vector3d& drill_point : drill_points) {
      const Eigen::Vector3d q = a_from_b * drill_point;
      for (const Eigen::Vector3d& p : jug_points) least = std::min(least, (p - q).squaredNorm());
    }
    least = std::sqrt(least);
    if (least < reach) {
      ++near;
      EXPECT_FALSE(apart(jug_plan, a, drill_plan, b));
    } else if (least > reach + error + 3 * spacing) {
      ++far;
      EXPECT_TRUE(apart(jug_plan, a, drill_plan, b));
    }
  }
  EXPECT_GT(near, 2);
  EXPECT_GT(far, 2);
}

}  // namespace
}  // namespace perch
