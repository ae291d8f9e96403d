#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "perch/core/camera.hpp"
#include "perch/core/error.hpp"
#include "perch/core/pose.hpp"
#include "perch/core/random.hpp"
#include "perch/core/stop.hpp"

namespace perch {
namespace {

using std::numbers::pi;

TEST(Pose, YawTurnsXTowardsY) {
  const Eigen::Vector3d p = world_from_model({1.0, 2.0, pi / 2}, 3.0) * Eigen::Vector3d(1, 0, 0);
  EXPECT_NEAR((p - Eigen::Vector3d(1, 3, 3)).norm(), 0, 1e-12);
}

TEST(Pose, AnglesWrap) {
  EXPECT_DOUBLE_EQ(wrap_angle(-pi), pi);
  EXPECT_DOUBLE_EQ(wrap_angle(pi), pi);
  EXPECT_NEAR(wrap_angle(7.0), 7.0 - 2 * pi, 1e-12);
  EXPECT_NEAR(angle_difference(0.1, 2 * pi - 0.1, 2 * pi), 0.2, 1e-12);
  EXPECT_NEAR(angle_difference(0.1, pi + 0.15, pi), 0.05, 1e-12);
}

TEST(RigidTransform, RefusesWhatIsNotRigid) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  EXPECT_NO_THROW(rigid_transform(m, "m"));
  m(0, 0) = 1.1;
  EXPECT_THROW(rigid_transform(m, "m"), InputError);
  m(0, 0) = -1;  // a mirror
  EXPECT_THROW(rigid_transform(m, "m"), InputError);
  m(0, 0) = 1;
  m(3, 0) = 0.5;
  EXPECT_THROW(rigid_transform(m, "m"), InputError);
  m(3, 0) = 0;
  m(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(rigid_transform(m, "m"), InputError);
}

TEST(Intrinsics, ChecksEveryField) {
  const Intrinsics good{640, 480, 525, 525, 319.5, 239.5};
  EXPECT_NO_THROW(good.check());
  for (const auto& broken : {Intrinsics{0, 480, 525, 525, 0, 0}, Intrinsics{640, 99999, 525, 525, 0, 0},
                             Intrinsics{640, 480, -1, 525, 0, 0}, Intrinsics{640, 480, 525, 0, 0, 0},
                             Intrinsics{640, 480, 525, 525, std::nan(""), 0}})
    EXPECT_THROW(broken.check(), InvalidSetting);
}

TEST(RaySlopes, PutAPixelBackWhereItProjects) {
  const Intrinsics k{640, 480, 525, 530, 319.5, 239.5};
  const RaySlopes rays(k);
  const Eigen::Vector3f p = rays.point(17, 401, 0.8F);
  EXPECT_NEAR(p.x() / p.z() * 525 + 319.5, 17, 1e-3);
  EXPECT_NEAR(p.y() / p.z() * 530 + 239.5, 401, 1e-3);
  EXPECT_EQ(p.z(), 0.8F);
}

TEST(Random, HasTheMomentsOfItsDistributions) {
  Random random(7);
  double sum = 0, squares = 0, uniform = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double x = random.normal();
    sum += x;
    squares += x * x;
    uniform += random.uniform();
  }
  EXPECT_NEAR(sum / n, 0, 0.02);
  EXPECT_NEAR(squares / n, 1, 0.02);
  EXPECT_NEAR(uniform / n, 0.5, 0.005);
}

TEST(Random, IsSplitMix64) {
  Random random(1234567);  // reference values of the published generator
  EXPECT_EQ(random.next(), 6457827717110365317ULL);
  EXPECT_EQ(random.next(), 3203168211198807973ULL);
}

TEST(StopCondition, StopsAtItsTimeOrWhenCancelled) {
  StopCondition never;
  EXPECT_FALSE(never());
  never.cancel();
  EXPECT_TRUE(never());
  EXPECT_TRUE(StopCondition::after(-1)());
  EXPECT_FALSE(StopCondition::after(1000)());
}

TEST(StopCondition, StopsWithinAnother) {
  StopCondition whole;
  const StopCondition part = StopCondition::within(whole, 1000);
  EXPECT_FALSE(part());
  EXPECT_TRUE(StopCondition::within(whole, -1).out_of_time());
  EXPECT_FALSE(StopCondition::within(whole, -1).cancelled());
  whole.cancel();
  EXPECT_TRUE(part.cancelled());
  const StopCondition over = StopCondition::after(-1);
  EXPECT_TRUE(StopCondition::within(over, 1000).out_of_time());
}

}  // namespace
}  // namespace perch
