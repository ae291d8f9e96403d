// Support planes and labels of raw frames, on scenes of planes and boxes whose depths are found by
// intersecting rays.

#include "perch/observation/support_plane.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/observation/raw_labels.hpp"

namespace perch {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// A box along the world's axes; its nature is what a label should say of it.
struct Block {
  Eigen::AlignedBox3d box;
  bool object = false;
};

struct Raw {
  Intrinsics k{320, 240, 262.5, 262.5, 159.5, 119.5};
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
  std::vector<Block> blocks;
  DepthImage ideal, depth;
  Image<int> seen;  ///< the block at each pixel, -1 for none

  Eigen::Vector3d up() const { return world_from_camera.linear().transpose() * Eigen::Vector3d::UnitZ(); }
};

Block block(double x0, double x1, double y0, double y1, double z0, double z1, bool object = false) {
  return {{Eigen::Vector3d(x0, y0, z0), Eigen::Vector3d(x1, y1, z1)}, object};
}

/// Where a ray enters a box, in units of its direction; infinity where it misses.
double entry(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& from, const Eigen::Vector3d& along) {
  double first = 0.0, last = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    double a = (box.min()[axis] - from[axis]) / along[axis], b = (box.max()[axis] - from[axis]) / along[axis];
    if (a > b) std::swap(a, b);
    first = std::max(first, a);
    last = std::min(last, b);
  }
  return first < last && first > 0.0 ? first : 1e9;
}

/// Looks at the origin from a distance and an elevation, rolled; then as a Kinect measures: disparities with
/// noise of half a step, rounded to steps of an eighth of a pixel (of 640).
void look(Raw& raw, Random& random, double elevation, double roll, double distance) {
  const double azimuth = random.uniform(-3.0, 3.0);
  const Eigen::Vector3d eye =
      distance * Eigen::Vector3d(std::cos(azimuth) * std::cos(elevation),
                                 std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
  const Eigen::Vector3d forward = -eye.normalized(),
                        right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d axes;
  axes << right, forward.cross(right), forward;
  raw.world_from_camera.linear() =
      axes * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  raw.world_from_camera.translation() = eye;
  raw.ideal = raw.depth = DepthImage(raw.k.width, raw.k.height, 0.0F);
  raw.seen = Image<int>(raw.k.width, raw.k.height, -1);
  const RaySlopes rays(raw.k);
  constexpr double focal_baseline = 525.0 * 0.075, step = 0.125;
  for (int v = 0; v < raw.k.height; ++v)
    for (int u = 0; u < raw.k.width; ++u) {
      const Eigen::Vector3d along = raw.world_from_camera.linear() * rays.point(u, v, 1.0F).cast<double>();
      double nearest = 1e9;
      for (std::size_t i = 0; i < raw.blocks.size(); ++i) {
        const double z = entry(raw.blocks[i].box, eye, along);
        if (z >= nearest) continue;
        nearest = z;
        raw.seen(u, v) = static_cast<int>(i);
      }
      const double noise = random.normal();
      if (nearest > 6.0) continue;
      raw.ideal(u, v) = static_cast<float>(nearest);
      const double disparity = focal_baseline / nearest + 0.5 * step * noise;
      raw.depth(u, v) = static_cast<float>(focal_baseline / (step * std::round(disparity / step)));
    }
}

/// A table of a size about the origin, its top at z = 0, with small boxes on it.
Raw table(Random& random, double size, int boxes, double largest = 0.12) {
  Raw raw;
  raw.blocks.push_back(block(-size, size, -size, size, -0.03, 0.0));
  for (int i = 0; i < boxes; ++i) {
    const double x = random.uniform(-0.25, 0.25), y = random.uniform(-0.25, 0.25),
                 a = random.uniform(0.02, 0.5 * largest), b = random.uniform(0.02, 0.5 * largest);
    raw.blocks.push_back(block(x - a, x + a, y - b, y + b, 0.0, random.uniform(0.04, 0.2), true));
  }
  return raw;
}

void expect_found(const Raw& raw, const PlaneSearch& search = {}) {
  const auto plane = find_support_plane(raw.depth, raw.k, search);
  ASSERT_TRUE(plane);
  EXPECT_LT(std::acos(std::min(1.0, plane->normal.dot(raw.up()))), 0.5 * degree);
  // Where the camera looks at: the world's origin.
  const Eigen::Vector3d origin = raw.world_from_camera.inverse() * Eigen::Vector3d::Zero();
  EXPECT_NEAR(plane->above(origin), 0.0, 0.002);
  EXPECT_NEAR(plane->normal.norm(), 1.0, 1e-12);
  const auto again = find_support_plane(raw.depth, raw.k, search);
  EXPECT_EQ(again->normal, plane->normal);
  EXPECT_EQ(again->distance, plane->distance);
}

template <typename Make>
void for_each_seed(const Make& make, double elevation_low = 25.0, double elevation_high = 60.0,
                   double roll = 5.0) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 22}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    Raw raw = make(random);
    look(raw, random, degree * random.uniform(elevation_low, elevation_high),
         degree * random.uniform(-roll, roll), random.uniform(0.7, 1.2));
    expect_found(raw);
    PlaneSearch told;
    told.seed = seed;
    told.up = raw.up();
    expect_found(raw, told);
  }
}

TEST(SupportPlane, OfATable) {
  for_each_seed([](Random& random) { return table(random, 1.0, 5); });
}

TEST(SupportPlane, AmongSeveralPlanes) {
  for_each_seed([](Random& random) {
    Raw raw = table(random, 0.5, 4);
    raw.blocks.push_back(block(-4, 4, -4, 4, -0.8, -0.7));                 // floor
    raw.blocks.push_back(block(-1.0, -0.9, -4, 4, -0.8, 2.0));             // wall
    raw.blocks.push_back(block(-0.9, -0.6, -0.5, 0.5, 0.35, 0.37));        // shelf
    raw.blocks.push_back(block(-0.3, -0.05, -0.3, -0.1, 0.0, 0.1, true));  // a large box
    return raw;
  });
}

TEST(SupportPlane, SeenFromATiltedCamera) {
  for_each_seed([](Random& random) { return table(random, 0.8, 5); }, 60.0, 85.0, 180.0);
  for_each_seed([](Random& random) { return table(random, 0.8, 5); }, 25.0, 60.0, 40.0);
}

TEST(SupportPlane, OfATableHalfCovered) {
  for_each_seed([](Random& random) { return table(random, 0.45, 22, 0.16); }, 35.0, 60.0);
}

TEST(SupportPlane, OfATableThatEndsInTheImage) {
  for_each_seed([](Random& random) {
    Raw raw = table(random, 0.25, 3);
    raw.blocks.push_back(block(-4, 4, -4, 4, -0.8, -0.7));
    return raw;
  });
}

TEST(SupportPlane, IsNotFoundWhereThereIsNone) {
  Random random(1);
  Raw raw;
  raw.blocks.push_back(block(-0.03, 0.03, -0.03, 0.03, -0.03, 0.03, true));
  look(raw, random, 0.6, 0.0, 0.9);
  EXPECT_FALSE(find_support_plane(raw.depth, raw.k, {}));
  EXPECT_FALSE(find_support_plane(DepthImage(320, 240, 0.0F), raw.k, {}));
  // A wall right ahead is none for a camera that is told where up is.
  raw = Raw();
  raw.blocks.push_back(block(-0.1, 0.0, -3, 3, -3, 3));
  look(raw, random, 0.05, 0.0, 1.0);
  PlaneSearch told;
  told.up = raw.up();
  EXPECT_FALSE(find_support_plane(raw.depth, raw.k, told));
}

/// Labels with the whole of the table within reach.
Image<RawLabel> labels_of(const Raw& raw) {
  const auto plane = find_support_plane(raw.depth, raw.k, {});
  const auto near_table = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d w = raw.world_from_camera * p;
    return w.head<2>().cwiseAbs().maxCoeff() < 0.6 && w.z() < 0.5;
  };
  return label_raw(raw.depth, raw.k, *plane, near_table, [](const Eigen::Vector3d&) { return true; });
}

TEST(RawLabels, TellObjectsFromTheTable) {
  std::int64_t of_table = 0, wrong = 0, of_objects = 0, lost = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    Raw raw = table(random, 1.0, 6);
    look(raw, random, degree * random.uniform(30, 60), 0.0, random.uniform(0.7, 1.1));
    const Image<RawLabel> labels = labels_of(raw);
    const RaySlopes rays(raw.k);
    for (int v = 0; v < raw.k.height; ++v)
      for (int u = 0; u < raw.k.width; ++u) {
        if (raw.seen(u, v) < 0) continue;
        const bool object = raw.blocks[static_cast<std::size_t>(raw.seen(u, v))].object;
        const double height = (raw.world_from_camera * rays.point(u, v, raw.ideal(u, v)).cast<double>()).z();
        if (!object) {
          ++of_table;
          wrong += labels(u, v) == RawLabel::object;
        } else if (height > 0.015) {
          ++of_objects;
          lost += labels(u, v) != RawLabel::object;
        }
      }
  }
  EXPECT_GT(of_objects, 20000);
  EXPECT_LT(wrong, of_table / 1000) << wrong << " of " << of_table;
  EXPECT_LT(lost, of_objects / 50) << lost << " of " << of_objects;
}

TEST(RawLabels, DoNotTrustMixedPixelsAndFliers) {
  std::int64_t mixed = 0, told = 0, fliers = 0, dropped = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    Raw raw = table(random, 1.0, 4);
    look(raw, random, degree * random.uniform(30, 50), 0.0, 0.9);
    std::vector<std::size_t> mixes, alone;
    for (int v = 2; v + 2 < raw.k.height; ++v)
      for (int u = 2; u + 2 < raw.k.width; ++u) {
        // Every fourth pixel beside a jump of more than 8 cm reads the mean of both sides.
        const float here = raw.ideal(u, v), right = raw.ideal(u + 1, v);
        if (here > 0 && right > 0 && std::abs(here - right) > 0.08F && (u + v) % 4 == 0) {
          raw.depth(u, v) = 0.5F * (here + right);
          mixes.push_back(raw.depth.index(u, v));
        } else if (random.uniform() < 0.0005) {
          raw.depth(u, v) = static_cast<float>(random.uniform(0.4, 0.65));
          alone.push_back(raw.depth.index(u, v));
        }
      }
    const Image<RawLabel> labels = labels_of(raw);
    mixed += static_cast<std::int64_t>(mixes.size());
    fliers += static_cast<std::int64_t>(alone.size());
    for (const std::size_t i : mixes) told += labels[i] == RawLabel::unknown;
    for (const std::size_t i : alone) dropped += labels[i] != RawLabel::object;
  }
  EXPECT_GT(mixed, 100);
  EXPECT_GT(fliers, 100);
  EXPECT_GT(told, mixed * 8 / 10) << told << " of " << mixed;
  EXPECT_GT(dropped, fliers * 95 / 100) << dropped << " of " << fliers;
}

}  // namespace
}  // namespace perch
