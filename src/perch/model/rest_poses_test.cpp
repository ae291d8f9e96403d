#include "perch/model/rest_poses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/model/convex_hull.hpp"
#include "perch/model/rest_orientation.hpp"

namespace perch {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// A box centred at the origin.
Mesh box_mesh(const Vector3d& size) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        (size.cwiseProduct(Vector3d((i & 1) - 0.5, ((i >> 1) & 1) - 0.5, (i >> 2) - 0.5))).cast<float>());
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// The solid between rings of `sides` points about z and a last point or ring; rings of radius 0 are points.
Mesh turned_mesh(const std::vector<std::pair<double, double>>& radius_z, std::uint32_t sides) {
  Mesh mesh;
  std::vector<std::uint32_t> first;
  for (const auto& [radius, z] : radius_z) {
    first.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    for (std::uint32_t i = 0; i < (radius > 0.0 ? sides : 1); ++i)
      mesh.vertices.push_back(
          Vector3d(radius * std::cos(2 * pi * i / sides), radius * std::sin(2 * pi * i / sides), z)
              .cast<float>());
  }
  for (std::size_t r = 0; r + 1 < first.size(); ++r)
    for (std::uint32_t i = 0; i < sides; ++i) {
      const bool low = radius_z[r].first > 0.0, high = radius_z[r + 1].first > 0.0;
      const std::uint32_t next = (i + 1) % sides, a = first[r] + (low ? i : 0),
                          b = first[r] + (low ? next : 0), c = first[r + 1] + (high ? next : 0),
                          d = first[r + 1] + (high ? i : 0);
      if (low) mesh.triangles.push_back({a, b, c});
      if (high) mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

Mesh cylinder_mesh(double radius, double height, std::uint32_t sides) {
  return turned_mesh({{0.0, 0.0}, {radius, 0.0}, {radius, height}, {0.0, height}}, sides);
}

Mesh moved(Mesh mesh, const Eigen::Isometry3d& by) {
  return transformed(std::move(mesh), by);
}

/// The solid angle of an a x b rectangle seen from `distance` above its middle, over that of the sphere.
double rectangle_share(double a, double b, double distance) {
  return 4.0 * std::atan(a * b / (2.0 * distance * std::sqrt(4.0 * distance * distance + a * a + b * b))) /
         (4.0 * pi);
}

double total(const std::vector<StablePose>& poses) {
  double sum = 0.0;
  for (const StablePose& pose : poses) sum += pose.share;
  return sum;
}

bool has_up(const std::vector<StablePose>& poses, const Vector3d& up) {
  return std::any_of(poses.begin(), poses.end(),
                     [&](const StablePose& p) { return (p.up - up).norm() < 1e-6; });
}

TEST(RestPoses, BoxOfThreeSides) {
  // Sides apart by more than the tolerance; each face looks like the one across.
  const Vector3d size(0.06, 0.09, 0.15);
  const auto poses = rest_poses(box_mesh(size));
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[0].up, Vector3d::UnitZ());
  EXPECT_NEAR(poses[0].share, 2 * rectangle_share(size.x(), size.y(), 0.5 * size.z()), 1e-6);
  EXPECT_NEAR(std::abs(poses[1].up.x()), 1.0, 1e-6);  // it lies on its largest side most likely
  EXPECT_NEAR(poses[1].share, 2 * rectangle_share(size.y(), size.z(), 0.5 * size.x()), 1e-6);
  EXPECT_NEAR(std::abs(poses[2].up.y()), 1.0, 1e-6);
  EXPECT_NEAR(poses[2].share, 2 * rectangle_share(size.x(), size.z(), 0.5 * size.y()), 1e-6);
  EXPECT_NEAR(total(poses), 1.0, 1e-6);
}

TEST(RestPoses, BoxMarkedOnAllSidesHasSix) {
  // A pin near a corner of the hull's inside would change nothing; a pit in one face tells the poses apart.
  RestPoseSettings settings;
  settings.tolerance = 1e-5;  // finer than what the pin below changes
  Mesh mesh = box_mesh({0.06, 0.09, 0.15});
  for (Eigen::Vector3f& p : mesh.vertices)  // a skewed box: no two faces alike
    p.x() += 0.05F * p.z() + 0.5F * p.y() * p.z() + 2.0F * p.x() * p.y() * p.z();
  EXPECT_EQ(rest_poses(box_mesh({0.06, 0.09, 0.15}), {}, settings).size(), 3U);
  EXPECT_GE(rest_poses(mesh, {}, settings).size(), 6U);
}

TEST(RestPoses, CubeHasOne) {
  const auto poses = rest_poses(box_mesh({0.05, 0.05, 0.05}));
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].up, Vector3d::UnitZ());
  EXPECT_NEAR(poses[0].share, 1.0, 1e-6);
}

TEST(RestPoses, SidesOfACylinderAreOne) {
  for (const std::uint32_t sides : {16U, 96U}) {
    SCOPED_TRACE(sides);
    const double radius = 0.03, height = 0.1;
    const auto poses = rest_poses(cylinder_mesh(radius, height, sides));
    ASSERT_EQ(poses.size(), 2U);  // its ends look the same
    EXPECT_EQ(poses[0].up, Vector3d::UnitZ());
    const double disc = (1.0 - 0.5 * height / std::hypot(0.5 * height, radius)) / 2.0;
    EXPECT_NEAR(poses[0].share, 2.0 * disc, 0.02);
    EXPECT_NEAR(poses[1].up.z(), 0.0, 1e-6);
    EXPECT_NEAR(total(poses), 1.0, 1e-6);
  }
}

TEST(RestPoses, DeclaredSymmetriesMakeOneOfWhatLooksDifferent) {
  // A rod of ten sides that are each 9 mm wide: not alike but for turns by 36 degrees, which are alike
  // anyway; a rod with unlike sides is one only where that is declared.
  Mesh mesh = cylinder_mesh(0.03, 0.15, 10);
  for (Eigen::Vector3f& p : mesh.vertices) p.x() *= p.x() > 0.0F ? 1.35F : 1.15F;
  const auto by_shape = rest_poses(mesh);
  EXPECT_GT(by_shape.size(), 2U);
  EXPECT_EQ(rest_poses(mesh, ModelSymmetries::about_z(Symmetry::continuous())).size(), 2U);
}

TEST(RestPoses, ConeStandsOrLies) {
  // The centre of mass of a cone is a quarter of its height up; tip and side line are no faces to stand on
  // but one of the side's.
  const auto poses = rest_poses(turned_mesh({{0.0, 0.0}, {0.03, 0.0}, {0.0, 0.09}}, 64));
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].up, Vector3d::UnitZ());
  // Seen from the side, the line it lies on slopes by radius over height: its normal is turned so much, and
  // up is the opposite of it.
  EXPECT_NEAR(poses[1].up.z(), -std::sin(std::atan2(0.03, 0.09)), 1e-3);
  EXPECT_NEAR(poses[0].share, (1.0 - 0.0225 / std::hypot(0.0225, 0.03)) / 2.0, 0.01);
  // A wide cone does not lie: its centre of mass is beyond the edge of the base.
  const auto wide = rest_poses(turned_mesh({{0.0, 0.0}, {0.09, 0.0}, {0.0, 0.04}}, 64));
  ASSERT_GE(wide.size(), 1U);
  EXPECT_EQ(wide[0].up, Vector3d::UnitZ());
}

TEST(RestPoses, TetrahedraOneOrFour) {
  const auto tetrahedron = [](const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    Mesh mesh;
    for (const Vector3d& p : {a, b, c, d}) mesh.vertices.push_back(p.cast<float>());
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    return mesh;
  };
  const double s = 0.04;
  const auto regular = rest_poses(tetrahedron({s, s, s}, {-s, -s, s}, {-s, s, -s}, {s, -s, -s}));
  EXPECT_EQ(regular.size(), 1U);
  // Its corners moved a little each its own way, so that no two faces are alike.
  const auto uneven = rest_poses(
      tetrahedron({1.3 * s, s, s}, {-s, -1.15 * s, s}, {-s, 1.1 * s, -1.2 * s}, {s, -s, -0.8 * s}));
  EXPECT_EQ(uneven.size(), 4U);
  EXPECT_NEAR(total(uneven), 1.0, 1e-6);
}

TEST(RestPoses, TipsOverFromWhereItIsTooHeavyOnOneSide) {
  // An L of square bars, 20 mm thick, feet of 20 mm and an arm of 100 mm: on its narrow foot the centre of
  // mass is beyond it. Its ends of 20 x 20 mm and the hull's slanted side are told by the closed form.
  Mesh mesh;
  const double corners[6][2] = {{0, 0}, {0.1, 0}, {0.1, 0.02}, {0.02, 0.02}, {0.02, 0.06}, {0, 0.06}};
  for (const double y : {0.0, 0.02})
    for (const auto& c : corners) mesh.vertices.push_back(Vector3d(c[0], y, c[1]).cast<float>());
  const std::uint32_t cap[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& t : cap) {
    mesh.triangles.push_back({t[0], t[1], t[2]});
    mesh.triangles.push_back({t[0] + 6, t[2] + 6, t[1] + 6});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.push_back({i, i + 6, j});
    mesh.triangles.push_back({j, i + 6, j + 6});
  }
  ASSERT_TRUE(is_closed(mesh));
  // Areas in the plane: 0.1 x 0.02 at (0.05, 0.01) and 0.02 x 0.04 at (0.01, 0.04).
  const double area = 0.002 + 0.0008, x = (0.002 * 0.05 + 0.0008 * 0.01) / area,
               z = (0.002 * 0.01 + 0.0008 * 0.04) / area;
  const VolumeCentroid mass = volume_centroid(mesh);
  EXPECT_NEAR(std::abs(mass.volume), area * 0.02, 1e-9);
  EXPECT_LT((mass.centroid - Vector3d(x, 0.01, z)).norm(), 1e-6);
  const auto poses = rest_poses(mesh);
  EXPECT_TRUE(has_up(poses, Vector3d::UnitZ()));                                       // on the long arm
  EXPECT_TRUE(has_up(poses, Vector3d::UnitX()));                                       // on the back, 60 mm
  EXPECT_TRUE(has_up(poses, Vector3d::UnitY()) || has_up(poses, -Vector3d::UnitY()));  // flat: mirror images,
  EXPECT_FALSE(has_up(poses, -Vector3d::UnitX()));  // its end of 20 mm: the mass is 18.6 mm up and inside ...
  // On its two tips, the hull's slanted side, from (0.1, 0.02) to (0.02, 0.06).
  const Vector3d slanted = -Vector3d(0.04, 0.0, 0.08).normalized();
  const bool foot_lies_inside = Vector3d(x - 0.1, 0, z - 0.02).dot(Vector3d(-0.08, 0, 0.04)) > 0.0 &&
                                Vector3d(x - 0.02, 0, z - 0.06).dot(Vector3d(0.08, 0, -0.04)) > 0.0;
  EXPECT_EQ(foot_lies_inside, std::any_of(poses.begin(), poses.end(), [&](const StablePose& p) {
              return (p.up - slanted).norm() < 1e-3;
            }));
}

TEST(RestPoses, SphereHasOne) {
  std::vector<std::pair<double, double>> rings;
  const int steps = 24;
  for (int i = 0; i <= steps; ++i)
    rings.emplace_back(i == 0 || i == steps ? 0.0 : 0.04 * std::sin(pi * i / steps),
                       -0.04 * std::cos(pi * i / steps));
  const auto poses = rest_poses(turned_mesh(rings, 48));
  EXPECT_EQ(poses.size(), 1U);
  EXPECT_NEAR(total(poses), 1.0, 1e-6);
}

TEST(RestPoses, OpenMeshIsFilled) {
  Mesh mesh = box_mesh({0.06, 0.09, 0.15});
  mesh.triangles.resize(mesh.triangles.size() - 2);  // without one side
  ASSERT_FALSE(is_closed(mesh));
  const auto poses = rest_poses(mesh);
  EXPECT_EQ(poses[0].up, Vector3d::UnitZ());
  EXPECT_NEAR(total(poses), 1.0, 1e-6);
}

TEST(RestPoses, InsideOutMakesNoDifference) {
  Mesh mesh = turned_mesh({{0.0, 0.0}, {0.03, 0.0}, {0.0, 0.09}}, 24);
  const auto outside = rest_poses(mesh);
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  const auto inside = rest_poses(mesh);
  ASSERT_EQ(outside.size(), inside.size());
  for (std::size_t i = 0; i < inside.size(); ++i) EXPECT_NEAR(inside[i].share, outside[i].share, 1e-9);
}

TEST(RestPoses, FlatOnesAreRefused) {
  const Mesh flat = box_mesh({0.1, 0.1, 0.0});
  EXPECT_THROW(rest_poses(flat), InputError);
  EXPECT_THROW(rest_poses(box_mesh({0.1, 0.0, 0.0})), InputError);
  EXPECT_THROW(rest_poses(box_mesh({0.0, 0.0, 0.0})), InputError);
  Mesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  EXPECT_THROW(rest_poses(triangle), InputError);
}

TEST(RestPoses, TurnWithTheModel) {
  // Whatever the frame, the same poses: a property that no single shape shows.
  Random random(7);
  const Mesh mesh = turned_mesh({{0.0, 0.0}, {0.04, 0.0}, {0.02, 0.1}, {0.0, 0.1}}, 24);
  const auto straight = rest_poses(mesh);
  for (int trial = 0; trial < 4; ++trial) {
    Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
    by.linear() = Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
                      .normalized()
                      .toRotationMatrix();
    by.translation() = Vector3d(random.normal(), random.normal(), random.normal());
    const auto turned = rest_poses(moved(mesh, by));
    ASSERT_EQ(turned.size(), straight.size()) << "seed 7, trial " << trial;
    for (const StablePose& pose : straight) {
      const auto found = std::find_if(turned.begin(), turned.end(), [&](const StablePose& p) {
        return std::abs(p.up.dot(by.linear() * Vector3d::UnitZ()) - pose.up.z()) < 0.02;
      });
      ASSERT_NE(found, turned.end()) << "seed 7, trial " << trial;
      EXPECT_NEAR(found->share, pose.share, 0.02);
    }
  }
}

TEST(RestPoses, ThoseThatStandHold) {
  // Every pose that is found has its centre of mass above what touches the plane.
  Random random(11);
  for (int trial = 0; trial < 6; ++trial) {
    SCOPED_TRACE("seed 11, trial " + std::to_string(trial));
    Mesh points;
    for (int i = 0; i < 30; ++i)
      points.vertices.push_back(Eigen::Vector3f(
          Vector3d(random.uniform(-0.1, 0.1), random.uniform(-0.06, 0.06), random.uniform(-0.04, 0.04))
              .cast<float>()));
    const Mesh mesh = convex_hull(points);
    ASSERT_TRUE(is_closed(mesh));
    const Vector3d centre = volume_centroid(mesh).centroid;
    RestPoseSettings all;
    all.least_share = 0.0;
    all.most = 1000;
    all.tolerance = 1e-6;
    const auto poses = rest_poses(mesh, {}, all);
    EXPECT_NEAR(total(poses), 1.0, 1e-6);
    for (const StablePose& pose : poses) {
      const Eigen::Matrix3d turn = rotation_to_up(pose.up);
      double lowest = 1.0;
      for (const auto& p : mesh.vertices) lowest = std::min(lowest, (turn * p.cast<double>()).z());
      // In the support polygon: on the left of every pair of touching points, all others being there too.
      std::vector<Eigen::Vector2d> feet;
      for (const auto& p : mesh.vertices) {
        const Vector3d q = turn * p.cast<double>();
        if (q.z() < lowest + 0.001) feet.emplace_back(q.head<2>());
      }
      const Eigen::Vector2d c = (turn * centre).head<2>();
      for (const auto& a : feet)
        for (const auto& b : feet) {
          const auto left = [&](const Eigen::Vector2d& p) {
            return (b - a).x() * (p - a).y() - (b - a).y() * (p - a).x() >= -1e-7;
          };
          EXPECT_TRUE(left(c) || !std::all_of(feet.begin(), feet.end(), left));
        }
    }
  }
}

TEST(ModelSymmetries, AboutUp) {
  const auto box = [] {
    ModelSymmetries s;
    for (int axis = 0; axis < 3; ++axis)
      s.discrete.emplace_back(Eigen::AngleAxisd(pi, Vector3d(Vector3d::Unit(axis))));
    return s;
  }();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d up = Vector3d::Unit(axis);
    EXPECT_EQ(box.about_up(up, 0.02).symmetry, Symmetry::n_fold(2));
    EXPECT_TRUE(box.equal_ups(up, -up, 0.02));
  }
  EXPECT_EQ(box.about_up(Vector3d(1, 1, 0).normalized(), 0.02).symmetry, Symmetry::none());
  EXPECT_FALSE(box.equal_ups(Vector3d::UnitX(), Vector3d::UnitY(), 0.02));
  EXPECT_EQ(ModelSymmetries::about_z(Symmetry::n_fold(6)).about_up(Vector3d::UnitZ(), 0.02).symmetry,
            Symmetry::n_fold(6));
  // A third of a turn and half a turn make a sixth.
  ModelSymmetries mixed;
  mixed.discrete.emplace_back(Eigen::AngleAxisd(2 * pi / 3, Vector3d::UnitZ()));
  mixed.discrete.emplace_back(Eigen::AngleAxisd(pi, Vector3d(-Vector3d::UnitZ())));
  EXPECT_EQ(mixed.about_up(Vector3d::UnitZ(), 0.02).symmetry, Symmetry::n_fold(6));
}

TEST(ModelSymmetries, AxesElsewhere) {
  // A can about a line off the origin, with ends alike.
  ModelSymmetries can;
  can.continuous.push_back({Vector3d::UnitZ(), Vector3d(0.01, 0.02, 0.0)});
  EXPECT_EQ(can.about_up(-Vector3d::UnitZ(), 0.02).symmetry, Symmetry::continuous());
  EXPECT_LT((can.about_up(Vector3d::UnitZ(), 0.02).point - Vector3d(0.01, 0.02, 0.0)).head<2>().norm(),
            1e-12);
  EXPECT_EQ(can.about_up(Vector3d::UnitX(), 0.02).symmetry, Symmetry::none());
  EXPECT_TRUE(can.equal_ups(Vector3d::UnitX(), Vector3d(0.6, 0.8, 0.0), 0.02));
  EXPECT_FALSE(can.equal_ups(Vector3d::UnitZ(), -Vector3d::UnitZ(), 0.02));
  // Half a turn about the line along x through (0.01, 0.02, 0.05), the can's middle.
  const Vector3d middle(0.01, 0.02, 0.05);
  can.discrete.push_back(Eigen::Translation3d(middle) * Eigen::AngleAxisd(pi, Vector3d::UnitX()) *
                         Eigen::Translation3d(-middle));
  const auto lying = can.about_up(Vector3d::UnitY(), 0.02);
  EXPECT_EQ(lying.symmetry, Symmetry::n_fold(2));
  EXPECT_NEAR(lying.point.z(), middle.z(), 1e-12);
  EXPECT_NEAR(lying.point.x(), middle.x(), 1e-12);
  EXPECT_TRUE(can.equal_ups(Vector3d::UnitZ(), -Vector3d::UnitZ(), 0.02));
  // And where it is itself vertical.
  const auto on_x = can.about_up(Vector3d::UnitX(), 0.02);
  EXPECT_EQ(on_x.symmetry, Symmetry::n_fold(2));
  EXPECT_LT((on_x.point - middle).tail<2>().norm(), 1e-9);
}

}  // namespace
}  // namespace perch
