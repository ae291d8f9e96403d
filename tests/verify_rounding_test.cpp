// What perch::verify allows for: that the program rounds, samples, and cuts off.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "perch/core/random.hpp"
#include "perch/model/collision.hpp"
#include "perch/observation/delta_index.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/sim/parametric_models.hpp"
#include "perch/verify/observed_points.hpp"
#include "perch/verify/sightings.hpp"
#include "perch/verify/solid.hpp"
#include "perch/verify/test_shapes.hpp"

namespace perch {
namespace {

/// Two of the same model side by side, ever closer: what is called a collision must be one to the program,
/// and objects that share most of their place are always found.
TEST(VerifyCollisionsHeavy, AreThoseOfTheProgram) {
  for (const char* name : {"can", "carton", "mug"}) {
    const SceneModel model = household_model(name);
    const ObjectModel object(model.name, model.mesh, model.symmetry, 0.0, 0.01);
    const Solid solid(model.mesh);
    const CollisionSettings settings;
    const double slack = depth_slack(solid, solid);
    EXPECT_GE(slack, object.solid().uncertainty() + object.solid().sample_radius());
    EXPECT_EQ(solid.is_closed(), object.solid().is_solid());
    Random random(7);
    bool found = false;
    for (int i = 0; i < 12; ++i) {
      const double angle = random.uniform(-3.0, 3.0), distance = 0.012 * i;
      const Pose a{}, b{distance * std::cos(angle), distance * std::sin(angle), random.uniform(-3.0, 3.0)};
      const Overlap overlap =
          overlap_of({&solid, world_from_model(a, 0.0)}, {&solid, world_from_model(b, 0.0)});
      const bool certain =
          overlap.depth > settings.penetration + slack || overlap.share > settings.overlap + share_slack;
      EXPECT_TRUE(!certain || collides(object, a, object, b, settings)) << name << " at " << distance;
      found = found || certain;
    }
    EXPECT_TRUE(found) << name;
  }
}

constexpr Intrinsics camera{640, 480, 525.0, 525.0, 319.5, 239.5};
constexpr Intrinsics telephoto{640, 480, 6000.0, 6000.0, 319.5, 239.5};

struct Drawn {
  std::size_t pixels = 0;     ///< drawn by the program
  std::size_t uncertain = 0;  ///< that may be missed

  Drawn& operator+=(const Drawn& other) {
    pixels += other.pixels;
    uncertain += other.uncertain;
    return *this;
  }
};

/// Every pixel that the program draws must be one that may be seen, at a depth that it may have; every other
/// one must be one that may be missed.
Drawn expect_drawn_within(const Mesh& mesh, const Eigen::Isometry3d& pose, const Intrinsics& k) {
  const DepthPatch patch = Rasterizer(k).render(mesh, pose);
  // Of each pixel: 1, it may be seen; 2, at the depth drawn; 4, it may be missed.
  Image<std::uint8_t> seen(k.width, k.height, 0);
  Drawn drawn;
  for (const Sighting& s : sightings(mesh, pose, k, 0)) {
    const int u = static_cast<int>(s.pixel) % k.width, v = static_cast<int>(s.pixel) / k.width;
    const double z = patch.at_or_none(u, v);
    seen[s.pixel] |= 1U | (s.depth.near <= z && z <= s.depth.far ? 2U : 0U) | (s.may_miss ? 4U : 0U);
    drawn.uncertain += s.may_miss;
  }
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const bool is_drawn = patch.at_or_none(u, v) < no_surface;
      drawn.pixels += is_drawn;
      const auto may = seen(u, v);
      EXPECT_TRUE(is_drawn ? (may & 2U) != 0 : may == 0 || (may & 4U) != 0)
          << "pixel " << u << ", " << v << ", depth " << patch.at_or_none(u, v);
    }
  return drawn;
}

Eigen::Quaterniond random_turn(Random& random) {
  return Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal()).normalized();
}

TEST(VerifySightings, HoldWhatTheProgramDraws) {
  Drawn all;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto& names = household_model_names();
    const Mesh mesh = household_model(names[random.below(names.size())]).mesh;
    const Eigen::Translation3d at(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2),
                                  random.uniform(-0.1, 0.9));
    all += expect_drawn_within(mesh, at * random_turn(random), camera);
  }
  EXPECT_GT(all.pixels, 50'000U);
  EXPECT_LT(all.uncertain, all.pixels / 1000);
}

/// Slender triangles, whose planes are known least well.
TEST(VerifySightings, HoldWhatTheProgramDrawsOfSlenderTriangles) {
  Drawn all;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Eigen::Translation3d at(0.0, 0.0, random.uniform(0.2, 0.6));
    all += expect_drawn_within(testing_verify::clutter(random, 200), at * random_turn(random), camera);
  }
  EXPECT_GT(all.pixels, 100'000U);
  EXPECT_LT(all.uncertain, all.pixels / 100);
}

/// A rectangle parallel to the image whose outlines run by pixel centres within a millionth to a hundredth of
/// a pixel, with a model's origin somewhere else.
void expect_outlines_within(std::uint64_t seed, const Intrinsics& k, Drawn& all) {
  SCOPED_TRACE(seed);
  Random random(seed);
  const double z = random.uniform(0.3, 2.0);
  const auto by = [&](double pixel) {
    return pixel + std::pow(10.0, random.uniform(-6.0, -2.0)) * (random.uniform() < 0.5 ? -1.0 : 1.0);
  };
  const double left = std::floor(random.uniform(0.0, 600.0)), top = std::floor(random.uniform(0.0, 440.0));
  const double u0 = by(left), u1 = by(left + 30.0), v0 = by(top), v1 = by(top + 30.0);
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(random.normal(), random.normal(), z) * random_turn(random);
  Mesh sheet;
  for (const auto& [u, v] : {std::pair{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}})
    sheet.vertices.push_back(
        (pose.inverse() * Eigen::Vector3d((u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z)).cast<float>());
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  all += expect_drawn_within(sheet, pose, k);
}

TEST(VerifySightings, HoldWhatTheProgramDrawsAtOutlines) {
  for (const Intrinsics& k : {camera, telephoto}) {
    SCOPED_TRACE(k.fx);
    Drawn all;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) expect_outlines_within(seed, k, all);
    EXPECT_GT(all.pixels, 100'000U);
    EXPECT_GT(all.uncertain, 1000U);
    EXPECT_LT(all.uncertain, all.pixels / 5);
  }
}

/// Where a distance differs from delta by more than its rounding, the program's test in single precision
/// knows.
TEST(VerifyDistances, RoundAsTheProgramsDo) {
  const RaySlopes rays(camera);
  Random random(1);
  int near_by = 0, differ = 0;
  for (int i = 0; i < 200'000; ++i) {
    const int u = static_cast<int>(random.below(640)), v = static_cast<int>(random.below(480));
    const auto z = static_cast<float>(random.uniform(0.3, 3.0));
    const int u2 = std::min(639, u + static_cast<int>(random.below(4))),
              v2 = std::max(0, v - static_cast<int>(random.below(4)));
    const auto z2 = static_cast<float>(z + random.uniform(-0.01, 0.01));
    const Eigen::Vector3d p = point_at(camera, static_cast<std::uint32_t>(v * 640 + u), z),
                          q = point_at(camera, static_cast<std::uint32_t>(v2 * 640 + u2), z2);
    const double distance = (p - q).norm();
    // A delta about as far off as rounding is.
    const double delta = distance + random.uniform(-5e-7, 5e-7) * p.norm();
    const auto single = static_cast<float>(delta);
    const bool within = within_delta(rays.point(u, v, z), rays.point(u2, v2, z2), single * single);
    differ += within != (distance <= delta);
    if (std::abs(distance - delta) <= distance_rounding(p, delta))
      ++near_by;
    else
      EXPECT_EQ(within, distance <= delta) << u << ", " << v << " at " << z << ", delta " << delta;
  }
  EXPECT_GT(near_by, 50'000);
  EXPECT_GT(differ, 500);  // the rounding is there
}

TEST(Verify, CutsOffAtTheProgramsNearPlane) {
  EXPECT_EQ(static_cast<float>(sight_near_plane), Rasterizer::near_plane);
}

}  // namespace
}  // namespace perch
