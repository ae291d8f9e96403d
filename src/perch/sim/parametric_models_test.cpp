#include "perch/sim/parametric_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"
#include "perch/sim/simulated_scene.hpp"

namespace perch {
namespace {

using std::numbers::pi;

/// The volume that a profile sweeps, from the frustums between its corners.
double swept_volume(const Profile& profile) {
  double volume = 0.0;
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const auto [r0, z0] = profile[i - 1];
    const auto [r1, z1] = profile[i];
    volume += pi / 3 * (z1 - z0) * (r0 * r0 + r0 * r1 + r1 * r1);
  }
  return volume;
}

/// A chord polygon of 48 corners covers 0.3 % less than its circle.
constexpr double tessellation = 4e-3;

class EveryModel : public testing::TestWithParam<std::string> {
 protected:
  const SceneModel model = household_model(GetParam());
};

TEST_P(EveryModel, IsClosedAndFacesOutwards) {
  EXPECT_EQ(mesh_fault(model.mesh), "");
  EXPECT_TRUE(is_closed(model.mesh));
  EXPECT_GT(signed_volume(model.mesh), 0.0);
  for (const auto& [a, b, c] : model.mesh.triangles) {
    const auto &p = model.mesh.vertices[a], &q = model.mesh.vertices[b], &r = model.mesh.vertices[c];
    EXPECT_GT((q - p).cross(r - p).norm(), 1e-10F) << "a triangle without area";
  }
}

TEST_P(EveryModel, StandsOnTheGroundInHouseholdSize) {
  const Eigen::AlignedBox3f bounds = model.mesh.bounds();
  EXPECT_EQ(bounds.min().z(), 0.0F);
  EXPECT_GE(bounds.sizes().maxCoeff(), 0.07F);
  EXPECT_LE(bounds.sizes().maxCoeff(), 0.30F);
  EXPECT_GE(model.mesh.triangles.size(), 500U);
  EXPECT_LE(model.mesh.triangles.size(), 5000U);
}

/// How a model looks at two yaws, over the pixels that it covers at either of them.
struct YawChange {
  double median;  ///< of |difference of depth|, metres; a pixel covered at one yaw only counts as 1 m
  double share;   ///< of the pixels whose depths differ by more than 5 mm or that are covered at one yaw only
};

/// Seen from the -y side, looking 38 degrees down.
YawChange yaw_change(const SceneModel& model, double yaw, double other_yaw) {
  SceneLayout layout;
  layout.camera = camera_looking_at({320, 240, 525, 525, 159.5, 119.5}, {0, -0.7, 0.63}, {0, 0, 0.08});
  layout.models = {model};
  const auto seen_at = [&](double angle) {
    layout.objects = {{0, {0, 0, angle}}};
    return render_layout(layout).depth;
  };
  const DepthImage a = seen_at(yaw), b = seen_at(other_yaw);
  std::vector<double> differences;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] != 0.0F || b[i] != 0.0F)
      differences.push_back(a[i] == 0.0F || b[i] == 0.0F ? 1.0 : std::abs(a[i] - b[i]));
  std::sort(differences.begin(), differences.end());
  const auto same = std::upper_bound(differences.begin(), differences.end(), 0.005);
  return {differences[differences.size() / 2],
          static_cast<double>(differences.end() - same) / static_cast<double>(differences.size())};
}

TEST_P(EveryModel, LooksAlikeExactlyWhereItsSymmetrySaysSo) {
  const double yaw = 0.35;
  const auto looks_alike = [&](double turn) {
    const YawChange change = yaw_change(model, yaw, yaw + turn);
    return change.median < 1e-3 && change.share < 0.03;
  };
  if (model.symmetry.is_continuous()) {
    for (const double turn : {0.1, 1.0, 2.5, 4.0}) EXPECT_TRUE(looks_alike(turn)) << turn;
    return;
  }
  for (int k = 1; k < model.symmetry.fold(); ++k) EXPECT_TRUE(looks_alike(k * model.symmetry.period())) << k;
  // And no finer symmetry than that.
  for (const int finer : {2, 3, 4, 5})
    EXPECT_GT(yaw_change(model, yaw, yaw + model.symmetry.period() / finer).share, 0.05) << finer;
}

INSTANTIATE_TEST_SUITE_P(Household, EveryModel, testing::ValuesIn(household_model_names()),
                         [](const auto& name) { return name.param; });

TEST(ParametricModels, RoundOnesHaveTheVolumeThatTheirProfileSweeps) {
  const auto expect_volume = [](const Mesh& mesh, const Profile& profile) {
    EXPECT_NEAR(signed_volume(mesh) / swept_volume(profile), 1.0, tessellation);
  };
  expect_volume(can_mesh(), can_profile({}));
  expect_volume(bottle_mesh(), bottle_profile({}));
  expect_volume(jar_mesh(), jar_profile({}));
  expect_volume(glass_mesh(), glass_profile({}));
  expect_volume(bowl_mesh(), bowl_profile({}));
}

TEST(ParametricModels, CanIsACylinderLessItsSunkLid) {
  const CanShape shape;
  const double cylinder = pi * shape.radius * shape.radius * shape.height;
  const double lid = pi * std::pow(shape.radius - 0.002, 2) * 0.003;
  EXPECT_NEAR(signed_volume(can_mesh(shape)) / (cylinder - lid), 1.0, 2 * tessellation);
}

TEST(ParametricModels, GlassHoldsTheFrustumThatItsInsideIs) {
  // Straight walls: what glass there is and what fits in make up the outer frustum.
  const GlassShape s;
  const auto frustum = [](double a, double b, double h) { return pi / 3 * h * (a * a + a * b + b * b); };
  const double lean = (s.rim_radius - s.bottom_radius) / s.height;
  const double inside =
      frustum(s.bottom_radius + lean * s.bottom - s.wall, s.rim_radius - s.wall, s.height - s.bottom);
  const double outside = frustum(s.bottom_radius, s.rim_radius, s.height);
  EXPECT_NEAR(signed_volume(glass_mesh(s)) / (outside - inside), 1.0, tessellation);
}

TEST(ParametricModels, BowlIsTwoQuarterEllipsesApart) {
  // Swept by r(z) from foot to rim along a quarter of an ellipse; numerically, in thin discs.
  const BowlShape s;
  const auto filled = [&](double foot, double rim, double bottom) {
    double volume = 0;
    constexpr int discs = 100000;
    for (int i = 0; i < discs; ++i) {
      const double c = 1 - (i + 0.5) / discs;  // the cosine of the arc's angle
      const double r = foot + (rim - foot) * std::sqrt(1 - c * c);
      volume += pi * r * r * (s.height - bottom) / discs;
    }
    return volume;
  };
  const double wall =
      filled(s.foot_radius, s.radius, 0) - filled(s.foot_radius - s.wall, s.radius - s.wall, s.wall);
  EXPECT_NEAR(signed_volume(bowl_mesh(s)) / wall, 1.0, 0.02);  // 12 chords instead of the arc
}

TEST(ParametricModels, BoxesAndPrismsAreExact) {
  const CartonShape carton;
  EXPECT_NEAR(signed_volume(carton_mesh(carton)) / carton.size.prod(), 1.0, 1e-6);
  for (const int sides : {3, 5, 6, 8}) {
    const TinShape tin{sides, 0.05, 0.09};
    const double area = 0.5 * sides * std::sin(2 * pi / sides) * tin.radius * tin.radius;
    EXPECT_NEAR(signed_volume(tin_mesh(tin)) / (area * tin.height), 1.0, 1e-5);
  }
}

TEST(ParametricModels, MugsHandleEndsInsideTheWall) {
  const MugShape s;
  const Mesh whole = mug_mesh(s);
  const std::size_t cup = revolve(subdivided(mug_profile(s), 0.012), 48).vertices.size();
  ASSERT_LT(cup, whole.vertices.size());
  float least = 1, most = 0;
  for (std::size_t i = cup; i < whole.vertices.size(); ++i) {
    const float radius = whole.vertices[i].head<2>().norm();
    least = std::min(least, radius);
    most = std::max(most, whole.vertices[i].x());
  }
  EXPECT_GT(least, s.radius - s.wall) << "the handle shows inside the mug";
  EXPECT_LT(least, s.radius * std::cos(pi / 48)) << "the handle doesn't reach the wall";
  EXPECT_NEAR(most, s.radius - s.wall / 2 + s.handle.reach + s.handle.half_thickness, 1e-3);
}

TEST(ParametricModels, UnknownNamesSayWhatThereIs) {
  try {
    household_model("teapot");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("teapot"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("spray_bottle"), std::string::npos);
  }
}

}  // namespace
}  // namespace perch
