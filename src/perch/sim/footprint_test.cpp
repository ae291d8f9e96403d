#include "perch/sim/footprint.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "perch/core/random.hpp"
#include "perch/sim/mesh_builder.hpp"

namespace perch {
namespace {

TEST(Footprint, OfABoxIsItsRectangle) {
  const Footprint footprint(box({0.2, 0.1, 0.3}, 0.02));
  ASSERT_EQ(footprint.corners().size(), 4U);
  for (const Eigen::Vector2d& corner : footprint.corners()) {
    EXPECT_NEAR(std::abs(corner.x()), 0.1, 1e-7);
    EXPECT_NEAR(std::abs(corner.y()), 0.05, 1e-7);
  }
}

TEST(Footprint, GapsOfBoxesAndDiscs) {
  const Footprint square(box({0.1, 0.1, 0.1}, 1));
  const Footprint disc(revolve(Profile{{0, 0}, {0.04, 0}, {0.04, 0.1}, {0, 0.1}}, 360));
  EXPECT_NEAR(gap(square.at({0, 0, 0}), square.at({0.15, 0.02, 0})), 0.05, 1e-7);
  EXPECT_NEAR(gap(square.at({0, 0, 0}), square.at({0.13, 0.14, 0})), std::hypot(0.03, 0.04), 1e-7);
  EXPECT_NEAR(gap(square.at({0, 0, 0}), square.at({0.2, 0, std::numbers::pi / 4})),
              0.2 - 0.05 - 0.05 * std::sqrt(2.0), 1e-7);
  EXPECT_NEAR(gap(disc.at({1, 2, 0.3}), disc.at({1.1, 2.1, 0})), std::hypot(0.1, 0.1) - 0.08, 1e-5);
  EXPECT_EQ(gap(square, disc), 0.0) << "one within the other";
  EXPECT_EQ(gap(square, square.at({0.09, 0, 0.2})), 0.0);
}

TEST(Footprint, AgreesWithPointsSampledOnBothSides) {
  Random random(2);
  const Footprint a(revolve(Profile{{0, 0}, {0.06, 0}, {0.06, 0.1}, {0, 0.1}}, 5)),
      b(box({0.12, 0.03, 0.1}, 1));
  const auto outline = [](const Footprint& f) {
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < f.corners().size(); ++i)
      for (int k = 0; k < 50; ++k)
        points.push_back(f.corners()[i] +
                         (f.corners()[(i + 1) % f.corners().size()] - f.corners()[i]) * (k / 50.0));
    return points;
  };
  const auto within = [](const Footprint& f, const Eigen::Vector2d& p) {
    for (std::size_t i = 0; i < f.corners().size(); ++i) {
      const Eigen::Vector2d s = f.corners()[(i + 1) % f.corners().size()] - f.corners()[i],
                            d = p - f.corners()[i];
      if (s.x() * d.y() - s.y() * d.x() < 0) return false;
    }
    return true;
  };
  int apart = 0, touching = 0;
  for (int i = 0; i < 300; ++i) {
    const Footprint p = a.at({random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0, 6)});
    const Footprint q = b.at({random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0, 6)});
    double least = std::numeric_limits<double>::infinity();
    bool overlap = false;
    for (const auto& x : outline(p)) {
      overlap = overlap || within(q, x);
      for (const auto& y : outline(q)) {
        least = std::min(least, (x - y).norm());
        overlap = overlap || within(p, y);
      }
    }
    if (overlap) {
      ++touching;
      EXPECT_EQ(gap(p, q), 0.0);
    } else if (least > 0.004) {  // closer than the samples are apart, they don't tell
      ++apart;
      EXPECT_LE(gap(p, q), least + 1e-12);
      EXPECT_GE(gap(p, q), least - 0.002);
    }
  }
  EXPECT_GT(apart, 50);
  EXPECT_GT(touching, 50);
}

}  // namespace
}  // namespace perch
