#include "perch/verify/sightings.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "perch/verify/test_shapes.hpp"

namespace perch {
namespace {

using testing_verify::box;
using testing_verify::clutter;
using testing_verify::random_pose;
using testing_verify::sphere;

constexpr Intrinsics small_camera{48, 36, 42.0, 42.6, 23.3, 17.6};

/// A triangle as its plane, offset = normal . x, and the planes through its sides and the camera: where a ray
/// meets the triangle, all three have the sign of the offset.
struct Facet {
  std::array<double, 3> normal;
  double offset;
  std::array<std::array<double, 3>, 3> sides;
};

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
std::array<double, 3> cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d c = a.cross(b);
  return {c.x(), c.y(), c.z()};
}

std::vector<Facet> facets_of(const Mesh& mesh, const Eigen::Isometry3d& pose) {
  std::vector<Facet> facets;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Eigen::Vector3d a = pose * mesh.vertices[ia].cast<double>(),
                          b = pose * mesh.vertices[ib].cast<double>(),
                          c = pose * mesh.vertices[ic].cast<double>(), normal = (b - a).cross(c - a);
    facets.push_back(
        {{normal.x(), normal.y(), normal.z()}, normal.dot(a), {cross(a, b), cross(b, c), cross(c, a)}});
  }
  return facets;
}

/// The nearest surface on a pixel's ray beyond the near plane, by all triangles, in double.
std::optional<double> depth_by_all(const std::vector<Facet>& facets, const Intrinsics& k, int u, int v) {
  const std::array<double, 3> ray{(u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0};
  double nearest = std::numeric_limits<double>::infinity();
  for (const Facet& facet : facets) {
    const double slope = dot(facet.normal, ray), z = facet.offset / slope;
    if (!(z >= sight_near_plane && z < nearest)) continue;
    // The point z ray has barycentric coordinates proportional to ray . (a x b) and so on.
    const double sign = facet.offset > 0.0 ? 1.0 : -1.0;
    if (std::all_of(facet.sides.begin(), facet.sides.end(),
                    [&](const auto& side) { return sign * dot(side, ray) >= 0.0; }))
      nearest = z;
  }
  if (!std::isfinite(nearest)) return std::nullopt;
  return nearest;
}

std::map<std::uint32_t, std::vector<Sighting>> by_pixel(const std::vector<Sighting>& all) {
  std::map<std::uint32_t, std::vector<Sighting>> pixels;
  for (const Sighting& s : all) pixels[s.pixel].push_back(s);
  return pixels;
}

/// The exact depths must lie in the ranges, and the ranges must say something.
void expect_truth_within(const Mesh& mesh, const Eigen::Isometry3d& pose, const Intrinsics& k,
                         std::size_t least_covered) {
  const auto all = sightings(mesh, pose, k, 7);
  const std::vector<Facet> facets = facets_of(mesh, pose);
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end(),
                             [](const Sighting& a, const Sighting& b) { return a.pixel < b.pixel; }));
  const auto pixels = by_pixel(all);
  std::size_t covered = 0, vague = 0;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const auto truth = depth_by_all(facets, k, u, v);
      const auto found = pixels.find(static_cast<std::uint32_t>(v * k.width + u));
      if (found == pixels.end()) {
        EXPECT_FALSE(truth) << "pixel " << u << ", " << v;
        continue;
      }
      const auto& ranges = found->second;
      if (!truth) {
        EXPECT_TRUE(ranges.front().may_miss) << "pixel " << u << ", " << v;
      } else {
        ++covered;
        EXPECT_TRUE(
            std::any_of(ranges.begin(), ranges.end(),
                        [&](const Sighting& s) { return s.depth.near <= *truth && *truth <= s.depth.far; }))
            << "pixel " << u << ", " << v << ": " << *truth;
      }
      double length = 0.0;
      for (const Sighting& s : ranges) {
        EXPECT_EQ(s.object, 7U);
        EXPECT_EQ(s.may_miss, ranges.front().may_miss);
        length += s.depth.far - s.depth.near;
      }
      vague += ranges.front().may_miss || ranges.size() > 1 || length > 1e-4;
    }
  EXPECT_GE(covered, least_covered);
  EXPECT_LE(vague, 6 + covered / 20);  // slender triangles have many sides and steep planes
}

TEST(Sightings, HoldTheExactDepth) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    Random random(seed);
    const Eigen::Isometry3d pose =
        random_pose(random, {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.2, 0.5)});
    expect_truth_within(box({-0.05F, -0.03F, -0.04F}, {0.1F, 0.06F, 0.08F}), pose, small_camera, 20);
    expect_truth_within(sphere(0.05, 10), pose, small_camera, 20);
    expect_truth_within(clutter(random, 60), pose, small_camera, 20);
  }
}

TEST(Sightings, HoldTheExactDepthFromWithin) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    Random random(seed);
    const Eigen::Isometry3d pose = random_pose(
        random, {random.uniform(-0.01, 0.01), random.uniform(-0.01, 0.01), random.uniform(-0.02, 0.05)});
    expect_truth_within(box({-0.05F, -0.03F, -0.04F}, {0.1F, 0.06F, 0.08F}), pose, small_camera, 200);
    expect_truth_within(clutter(random, 100), pose, small_camera, 10);
  }
}

// An outline that runs exactly through pixel centres: those pixels may be seen or not, all others are
// certain.
TEST(Sightings, OutlinesThroughPixelCentresAreUncertain) {
  const Intrinsics k{40, 30, 100.0, 100.0, 20.0, 15.0};
  Mesh sheet;  // from pixel column 10 to 30.5, row 5 to 20.5, at 1 m
  sheet.vertices = {
      {-0.1F, -0.1F, 0.0F}, {0.105F, -0.1F, 0.0F}, {0.105F, 0.055F, 0.0F}, {-0.1F, 0.055F, 0.0F}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto pixels = by_pixel(sightings(sheet, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 1)), k, 0));
  EXPECT_EQ(pixels.size(), 21U * 16U);
  for (const auto& [pixel, ranges] : pixels) {
    const auto u = pixel % 40, v = pixel / 40;
    EXPECT_EQ(ranges.front().may_miss, u == 10 || v == 5) << u << ", " << v;
    ASSERT_EQ(ranges.size(), 1U);
    EXPECT_NEAR(ranges.front().depth.near, 1.0, 1e-5);
    EXPECT_NEAR(ranges.front().depth.far, 1.0, 1e-5);
  }
}

// Seen along its side, a wall may have any depth from its front to its back.
TEST(Sightings, AWallSeenEdgeOnHasAllItsDepths) {
  const Intrinsics k{40, 30, 100.0, 100.0, 20.0, 15.0};
  Mesh wall;
  wall.vertices = {{0.0F, -0.1F, 0.5F}, {0.0F, 0.1F, 0.5F}, {0.0F, 0.1F, 1.0F}, {0.0F, -0.1F, 1.0F}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  const auto pixels = by_pixel(sightings(wall, Eigen::Isometry3d::Identity(), k, 0));
  const auto middle = pixels.find(15 * 40 + 20);
  ASSERT_NE(middle, pixels.end());
  EXPECT_TRUE(middle->second.front().may_miss);
  EXPECT_NEAR(middle->second.front().depth.near, 0.5, 1e-5);
  EXPECT_NEAR(middle->second.back().depth.far, 1.0, 1e-5);
}

TEST(Sightings, NothingIsSeenBehindOrBesideOrVeryFar) {
  const Mesh mesh = sphere(0.05, 10);
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(0, 0, -0.5), Eigen::Vector3d(2, 0, 0.5),
                                    Eigen::Vector3d(0, 0, 1e12), Eigen::Vector3d(1e300, 0, 0)})
    EXPECT_TRUE(sightings(mesh, Eigen::Isometry3d(Eigen::Translation3d(at)), small_camera, 0).empty());
}

}  // namespace
}  // namespace perch
