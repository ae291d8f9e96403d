// What a view shows, against the triangles themselves: points on them, normals across them, rays past them.

#include "perch/refine/surface_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "perch/refine/icp_test_support.hpp"

namespace perch {
namespace {

struct Corners {
  Eigen::Vector3d a, b, c;

  Eigen::Vector3d normal() const { return (b - a).cross(c - a).normalized(); }
};

std::vector<Corners> triangles_of(const Mesh& mesh, const Eigen::Isometry3d& world_from_model) {
  std::vector<Corners> triangles;
  const auto corner = [&](std::uint32_t i) -> Eigen::Vector3d {
    return world_from_model * mesh.vertices[i].cast<double>();
  };
  for (const auto& t : mesh.triangles) triangles.push_back({corner(t[0]), corner(t[1]), corner(t[2])});
  return triangles;
}

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - along * (b - a)).norm();
}

double distance(const Eigen::Vector3d& p, const Corners& t) {
  const Eigen::Vector3d n = t.normal();
  const auto inside = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (b - a).cross(p - a).dot(n) >= 0.0;
  };
  if (inside(t.a, t.b) && inside(t.b, t.c) && inside(t.c, t.a)) return std::abs((p - t.a).dot(n));
  return std::min(
      {distance_to_segment(p, t.a, t.b), distance_to_segment(p, t.b, t.c), distance_to_segment(p, t.c, t.a)});
}

/// True where a triangle is in the way from the eye to a point, but for the last 0.1 mm.
bool is_hidden(const Eigen::Vector3d& p, const Eigen::Vector3d& eye, const std::vector<Corners>& triangles) {
  const Eigen::Vector3d way = p - eye;
  return std::any_of(triangles.begin(), triangles.end(), [&](const Corners& t) {
    const Eigen::Vector3d n = (t.b - t.a).cross(t.c - t.a);
    const double slope = n.dot(way), share = n.dot(t.a - eye) / slope;
    if (slope == 0.0 || share <= 0.0 || share >= 1.0 - 1e-4 / way.norm()) return false;
    const Eigen::Vector3d hit = eye + share * way;
    const auto inside = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return (b - a).cross(hit - a).dot(n) >= 0.0;
    };
    return inside(t.a, t.b) && inside(t.b, t.c) && inside(t.c, t.a);
  });
}

struct Body {
  std::string name;
  Mesh mesh;
  Symmetry symmetry;
  /// How far a point of it may lie off the mesh at any yaw of its symmetry, metres, and a normal off those of
  /// the mesh around, radians.
  double off_surface, off_normal;
};

std::vector<Body> bodies() {
  constexpr double rounding = 1e-5, degree = std::numbers::pi / 180.0;
  const double rise = 0.04 * (1.0 - std::cos(std::numbers::pi / 64.0));  // of the can's round over its sides
  return {{"wedge", wedge(), Symmetry::none(), rounding, degree},
          {"post and block", post_and_block(), Symmetry::none(), rounding, degree},
          {"hexagon", regular_prism(6, 0.05F, 0.08F), Symmetry::n_fold(6), rounding, degree},
          {"can", round_can(), Symmetry::continuous(), rounding + rise, 15.0 * degree}};
}

constexpr double eye_distance = 0.8;  // metres
constexpr int sample_count = 400;

/// An eye, and a pose that it sees an object at.
struct Look {
  Eigen::Vector3d eye;
  Pose pose;
};

Look random_look(Random& random, const ObjectModel& model) {
  const Pose pose{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-7, 7)};
  const double bearing = random.uniform(-3.1, 3.1), elevation = random.uniform(-1.5, 1.5);
  const Eigen::Vector3d middle(pose.x, pose.y, model.origin_z() + 0.5 * model.height());
  const Eigen::Vector3d outwards(std::cos(elevation) * std::cos(bearing),
                                 std::cos(elevation) * std::sin(bearing), std::sin(elevation));
  return {middle + eye_distance * outwards, pose};
}

/// A view's samples where the object stands, world frame.
struct Placed {
  std::vector<Eigen::Vector3d> points, normals;
};

Placed placed(const SurfaceViews::View& view, const ObjectModel& model, const Pose& pose) {
  const Eigen::Isometry3d world_from_view = model.world_from_model({pose.x, pose.y, view.yaw});
  Placed samples;
  for (std::size_t i = 0; i < view.samples.size(); ++i) {
    samples.points.emplace_back(world_from_view * view.samples.point(i).cast<double>());
    samples.normals.emplace_back(world_from_view.linear() * view.samples.normal(i).cast<double>());
  }
  return samples;
}

/// Asks what a body shows from many sides, with its triangles at the pose asked for.
template <typename Check>
void look_from_many_sides(const Body& body, const Check& check) {
  const ObjectModel model = object(body.mesh, body.symmetry, 0.3);
  const SurfaceViews views(model, eye_distance, sample_count);
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << body.name << ", seed " << seed);
    Random random(seed);
    const auto [eye, pose] = random_look(random, model);
    const SurfaceViews::View view = views.from(eye, pose);
    EXPECT_NEAR(body.symmetry.yaw_difference(view.yaw, pose.yaw), 0.0, 1e-9);
    EXPECT_GT(view.samples.size(), sample_count / 2);
    EXPECT_LT(view.samples.size(), 2 * sample_count);
    check(placed(view, model, pose), triangles_of(body.mesh, model.world_from_model(pose)), eye, random);
  }
}

// At the pose asked for, though the view may be that of another yaw where the object is symmetric.
TEST(SurfaceViewsHeavy, SamplesLieOnTheSurface) {
  for (const Body& body : bodies())
    look_from_many_sides(body, [&](const Placed& samples, const std::vector<Corners>& triangles,
                                   const Eigen::Vector3d& /*eye*/, Random& /*random*/) {
      for (const Eigen::Vector3d& p : samples.points) {
        double least = 1.0;
        for (const Corners& t : triangles) least = std::min(least, distance(p, t));
        EXPECT_LT(least, body.off_surface);
      }
    });
}

// Where the surface around is smooth. Not where a nearer part of the body ends in front of it: a normal from
// differences may take that part's depth for its neighbour's, if they lie only a few centimetres apart.
TEST(SurfaceViewsHeavy, NormalsAreThoseOfTheSurface) {
  constexpr double around = 0.003;  // metres: more than two pixels of the rendering
  for (const Body& body : bodies()) {
    std::size_t smooth = 0, wrong = 0, all = 0;
    look_from_many_sides(body, [&](const Placed& samples, const std::vector<Corners>& triangles,
                                   const Eigen::Vector3d& eye, Random& /*random*/) {
      for (std::size_t i = 0; i < samples.points.size(); ++i) {
        const Eigen::Vector3d &p = samples.points[i], &normal = samples.normals[i];
        EXPECT_NEAR(normal.norm(), 1.0, 1e-5);
        // The view may be half a bin off in both angles, and nearer to the point than the eye is.
        EXPECT_GT(normal.dot((eye - p).normalized()), -0.17) << "turned to the camera";
        ++all;
        std::vector<Eigen::Vector3d> normals;
        for (const Corners& t : triangles)
          if (distance(p, t) < around) normals.push_back(t.normal());
        const auto alike = [&](const Eigen::Vector3d& direction, double angle) {
          return std::all_of(normals.begin(), normals.end(),
                             [&](const Eigen::Vector3d& n) { return n.dot(direction) > std::cos(angle); });
        };
        if (normals.empty() || !alike(normals.front(), body.off_normal)) continue;
        ++smooth;
        wrong += !alike(normal, body.off_normal);
      }
    });
    SCOPED_TRACE(body.name);
    EXPECT_GT(static_cast<double>(smooth), 0.7 * static_cast<double>(all));
    EXPECT_LT(static_cast<double>(wrong), 0.005 * static_cast<double>(smooth));
  }
}

// The view is that of a direction up to half a bin off: a few samples lie beyond the edge of what is seen.
TEST(SurfaceViews, SamplesAreInView) {
  for (const Body& body : bodies())
    look_from_many_sides(body, [&](const Placed& samples, const std::vector<Corners>& triangles,
                                   const Eigen::Vector3d& eye, Random& /*random*/) {
      const auto hidden = std::count_if(samples.points.begin(), samples.points.end(),
                                        [&](const auto& p) { return is_hidden(p, eye, triangles); });
      EXPECT_LT(static_cast<double>(hidden), 0.1 * static_cast<double>(samples.points.size()));
    });
}

// Any point of the surface that the eye sees at more than 20 degrees has a sample nearby.
TEST(SurfaceViews, SamplesCoverWhatIsInView) {
  for (const Body& body : bodies()) {
    std::size_t seen = 0, covered = 0;
    look_from_many_sides(body, [&](const Placed& samples, const std::vector<Corners>& triangles,
                                   const Eigen::Vector3d& eye, Random& random) {
      for (int k = 0; k < 300; ++k) {
        const Corners& t = triangles[random.below(triangles.size())];
        const double r = std::sqrt(random.uniform()), s = random.uniform();
        const Eigen::Vector3d p = (1.0 - r) * t.a + r * (1.0 - s) * t.b + r * s * t.c;
        if (t.normal().dot((eye - p).normalized()) < std::sin(0.35) || is_hidden(p, eye, triangles)) continue;
        ++seen;
        covered += std::any_of(samples.points.begin(), samples.points.end(),
                               [&](const auto& sample) { return (sample - p).norm() < 0.015; });
      }
    });
    SCOPED_TRACE(body.name);
    EXPECT_GT(seen, 1000U);
    EXPECT_GT(static_cast<double>(covered), 0.98 * static_cast<double>(seen));
  }
}

bool same(const SurfaceSamples& a, const SurfaceSamples& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z && a.nx == b.nx && a.ny == b.ny && a.nz == b.nz;
}

TEST(SurfaceViews, AreTheSameForPosesThatLookAlike) {
  const ObjectModel hexagon = object(regular_prism(6, 0.05F, 0.08F), Symmetry::n_fold(6)),
                    can = object(round_can(), Symmetry::continuous());
  const SurfaceViews hexagon_views(hexagon, eye_distance, sample_count),
      can_views(can, eye_distance, sample_count);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const auto [eye, pose] = random_look(random, hexagon);
    const SurfaceViews::View view = hexagon_views.from(eye, pose), round = can_views.from(eye, pose);
    for (const int turns : {-4, 1, 2, 11}) {
      const Pose turned{pose.x, pose.y, pose.yaw + turns * hexagon.symmetry().period()};
      const SurfaceViews::View other = hexagon_views.from(eye, turned);
      EXPECT_TRUE(same(other.samples, view.samples));
      EXPECT_NEAR(other.yaw, view.yaw, 1e-9);
    }
    for (int turns = 0; turns < 4; ++turns) {
      const SurfaceViews::View other = can_views.from(eye, {pose.x, pose.y, random.uniform(-7, 7)});
      EXPECT_TRUE(same(other.samples, round.samples));
      EXPECT_EQ(other.yaw, round.yaw);
    }
  }
}

// Whoever asks first: in one order, in the other, and several at once for the same.
TEST(SurfaceViews, DoNotDependOnWhoAsksFirst) {
  const ObjectModel model = object(post_and_block());
  std::vector<Look> looks;
  Random random(1);
  for (int i = 0; i < 30; ++i) looks.push_back(random_look(random, model));
  const auto ask = [&](const SurfaceViews& views, std::size_t i) {
    return views.from(looks[i].eye, looks[i].pose).samples;
  };
  const SurfaceViews views(model, eye_distance, sample_count);
  std::vector<SurfaceSamples> expected;
  for (std::size_t i = 0; i < looks.size(); ++i) expected.push_back(ask(views, i));
  const SurfaceViews backwards(model, eye_distance, sample_count);
  for (std::size_t i = looks.size(); i-- > 0;) EXPECT_TRUE(same(ask(backwards, i), expected[i])) << i;

  for (int round = 0; round < 5; ++round) {
    const SurfaceViews shared(model, eye_distance, sample_count);
    std::array<std::vector<SurfaceSamples>, 4> found;
    {
      std::vector<std::jthread> askers;
      for (std::vector<SurfaceSamples>& samples : found)
        askers.emplace_back([&] {
          for (std::size_t i = 0; i < looks.size(); ++i) samples.push_back(ask(shared, i));
        });
    }
    for (const std::vector<SurfaceSamples>& samples : found)
      for (std::size_t i = 0; i < looks.size(); ++i) EXPECT_TRUE(same(samples[i], expected[i])) << i;
  }
}

}  // namespace
}  // namespace perch
