#include "perch/model/solid_volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "perch/core/random.hpp"
#include "perch/model/surface_samples.hpp"

namespace perch {
namespace {

using std::numbers::pi;
constexpr double margin = 0.01;
constexpr float unbounded = std::numeric_limits<float>::infinity();

std::uint32_t number(std::size_t i) {
  return static_cast<std::uint32_t>(i);
}

/// The solid between z = 0 and `height` over a polygon (counter-clockwise) whose first corner sees all of it.
Mesh prism(const std::vector<Eigen::Vector2f>& base, float height) {
  Mesh mesh;
  for (const float z : {0.0F, height})
    for (const Eigen::Vector2f& p : base) mesh.vertices.emplace_back(p.x(), p.y(), z);
  const std::uint32_t n = number(base.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.triangles.push_back({i, next, n + next});
    mesh.triangles.push_back({i, n + next, n + i});
    if (i == 0 || next == 0) continue;
    mesh.triangles.push_back({0, next, i});
    mesh.triangles.push_back({n, n + i, n + next});
  }
  return mesh;
}

/// The solid that the area left of the line through (radius, height) sweeps about z.
Mesh revolved(const std::vector<Eigen::Vector2d>& profile, std::size_t around) {
  Mesh mesh;
  for (const Eigen::Vector2d& p : profile)
    for (std::size_t j = 0; j < around; ++j) {
      const double angle = 2.0 * pi * static_cast<double>(j) / static_cast<double>(around);
      mesh.vertices.push_back(
          Eigen::Vector3d(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()).cast<float>());
    }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    for (std::size_t j = 0; j < around; ++j) {
      const std::size_t next = (j + 1) % around, a = i * around, b = a + around;
      mesh.triangles.push_back({number(a + j), number(a + next), number(b + j)});
      mesh.triangles.push_back({number(a + next), number(b + next), number(b + j)});
    }
  return mesh;
}

Mesh sphere(double radius, int rings) {
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i <= rings; ++i)
    profile.emplace_back(i % rings == 0 ? 0.0 : radius * std::sin(pi * i / rings),
                         -radius * std::cos(pi * i / rings));
  return revolved(profile, 2 * static_cast<std::size_t>(rings));
}

constexpr double cup_radius = 0.04, cup_wall = 0.006, cup_height = 0.09;
constexpr std::size_t cup_sides = 24;

Mesh cup() {
  return revolved({{0.0, 0.0},
                   {cup_radius, 0.0},
                   {cup_radius, cup_height},
                   {cup_radius - cup_wall, cup_height},
                   {cup_radius - cup_wall, cup_wall},
                   {0.0, cup_wall}},
                  cup_sides);
}

/// A ring that lies flat: a tube of this radius about a circle.
Mesh torus(double ring, double tube) {
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i < 16; ++i)
    profile.emplace_back(ring + tube * std::cos(pi * i / 8), tube * std::sin(pi * i / 8));
  profile.push_back(profile.front());
  return revolved(profile, 32);
}

Mesh moved(Mesh mesh, const Eigen::Isometry3f& by) {
  for (Eigen::Vector3f& p : mesh.vertices) p = by * p;
  return mesh;
}

std::array<Eigen::Vector3d, 3> corners(const Mesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  return {mesh.vertices[triangle[0]].cast<double>(), mesh.vertices[triangle[1]].cast<double>(),
          mesh.vertices[triangle[2]].cast<double>()};
}

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double length2 = (b - a).squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(b - a) / length2, 0.0, 1.0) : 0.0;
  return (a + t * (b - a) - p).norm();
}

double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
  const Eigen::Vector3d n = (b - a).cross(c - a);
  const bool above = n.squaredNorm() > 0.0 && (b - a).cross(p - a).dot(n) >= 0.0 &&
                     (c - b).cross(p - b).dot(n) >= 0.0 && (a - c).cross(p - c).dot(n) >= 0.0;
  if (above) return std::abs((p - a).dot(n)) / n.norm();
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

double distance_to_surface(const Mesh& mesh, const Eigen::Vector3d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, triangle);
    nearest = std::min(nearest, distance_to_triangle(p, a, b, c));
  }
  return nearest;
}

/// How often the surface wraps p: the solid angle that it fills, over 4 pi (Van Oosterom and Strackee 1983).
double winding_number(const Mesh& mesh, const Eigen::Vector3d& p) {
  double angle = 0.0;
  for (const auto& triangle : mesh.triangles) {
    auto [a, b, c] = corners(mesh, triangle);
    a -= p, b -= p, c -= p;
    angle += 2.0 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                     b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return angle / (4.0 * pi);
}

/// Positive inside.
double true_depth(const Mesh& mesh, const Eigen::Vector3d& p) {
  const double distance = distance_to_surface(mesh, p);
  return std::abs(winding_number(mesh, p)) > 0.5 ? distance : -distance;
}

Eigen::Vector3f random_point(const Eigen::AlignedBox3f& box, Random& random) {
  const auto along = [&](float low, float high) { return static_cast<float>(random.uniform(low, high)); };
  const Eigen::Vector3f low = box.min(), high = box.max();
  return {along(low.x(), high.x()), along(low.y(), high.y()), along(low.z(), high.z())};
}

Eigen::Vector3f random_surface_point(const Mesh& mesh, Random& random) {
  const auto [a, b, c] = corners(mesh, mesh.triangles[random.below(mesh.triangles.size())]);
  const double s = random.uniform(), t = random.uniform(0.0, 1.0 - s);
  return (a + s * (b - a) + t * (c - a)).cast<float>();
}

struct Shape {
  std::string name;
  Mesh mesh;
};

std::vector<Shape> solids() {
  const std::vector<Eigen::Vector2f> square{{0, 0}, {0.08F, 0}, {0.08F, 0.05F}, {0, 0.05F}};
  const std::vector<Eigen::Vector2f> corner{{0, 0},         {0.1F, 0},     {0.1F, 0.03F},
                                            {0.03F, 0.03F}, {0.03F, 0.1F}, {0, 0.1F}};
  std::vector<Shape> shapes{{"box", prism(square, 0.12F)}, {"L", prism(corner, 0.04F)},
                            {"sphere", sphere(0.05, 14)},  {"cup", cup()},
                            {"torus", torus(0.05, 0.015)}, {"thin plate", prism(square, 0.002F)}};
  const Eigen::Isometry3f tilt = Eigen::Translation3f(0.3F, -0.2F, 0.1F) *
                                 Eigen::AngleAxisf(0.7F, Eigen::Vector3f(1, 2, 3).normalized());
  for (const char* name : {"box", "L", "cup", "torus"}) {
    const auto shape =
        std::find_if(shapes.begin(), shapes.end(), [&](const Shape& s) { return s.name == name; });
    shapes.push_back({"tilted " + shape->name, moved(shape->mesh, tilt)});
  }
  Mesh inside_out = prism(square, 0.12F);
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  shapes.push_back({"box turned inside out", inside_out});
  return shapes;
}

TEST(SolidVolumeHeavy, BoundsTheDepthOfPoints) {
  for (const auto& [name, mesh] : solids()) {
    const SolidVolume volume(mesh, margin);
    ASSERT_TRUE(volume.is_solid()) << name;
    Eigen::AlignedBox3f box = mesh.bounds();
    box.min().array() -= static_cast<float>(margin);
    box.max().array() += static_cast<float>(margin);
    Random random(11);
    const double uncertainty = volume.uncertainty();
    double deepest = 0.0;
    for (int i = 0; i < 1500; ++i) {
      const Eigen::Vector3f p = i % 3 ? random_point(box, random)
                                      : Eigen::Vector3f(random_surface_point(mesh, random) +
                                                        0.003F * random_point({Eigen::Vector3f::Constant(-1),
                                                                               Eigen::Vector3f::Constant(1)},
                                                                              random));
      const double depth = true_depth(mesh, p.cast<double>());
      const float bound = volume.depth_lower_bound(p);
      deepest = std::max(deepest, depth);
      if (bound == -unbounded) {
        ASSERT_LE(depth, uncertainty) << name << " at " << p.transpose();
      } else {
        ASSERT_GT(bound, 0.0F) << name << " at " << p.transpose();
        ASSERT_LE(bound, depth + 1e-6) << name << " at " << p.transpose();
        ASSERT_GT(bound, depth - uncertainty - 1e-6) << name << " at " << p.transpose();
        ASSERT_LE(bound, volume.greatest_depth()) << name << " at " << p.transpose();
      }
      ASSERT_NEAR(volume.signed_distance(p), depth, 0.5 * uncertainty + 1e-6)
          << name << " at " << p.transpose();
    }
    EXPECT_GE(volume.greatest_depth(), deepest - uncertainty) << name;
  }
}

TEST(SolidVolume, KnowsNothingBeyondItsField) {
  const Mesh mesh = sphere(0.05, 14);
  const SolidVolume volume(mesh, margin);
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(0.1F, 0, 0), Eigen::Vector3f(0, -0.1F, 0), Eigen::Vector3f(0, 0, 0.1F),
        Eigen::Vector3f(1e9F, 0, 0), Eigen::Vector3f(0, -1e9F, 0)}) {
    EXPECT_EQ(volume.signed_distance(p), -unbounded) << p.transpose();
    EXPECT_EQ(volume.depth_lower_bound(p), -unbounded) << p.transpose();
  }
  EXPECT_EQ(SolidVolume().depth_lower_bound(Eigen::Vector3f::Zero()), -unbounded);
}

TEST(SolidVolume, LeavesTheCavityOfACupOutside) {
  const SolidVolume volume(cup(), margin);
  Random random(2);
  const double inner = (cup_radius - cup_wall) * std::cos(pi / cup_sides);
  for (int i = 0; i < 5000; ++i) {
    const double radius = inner * std::sqrt(random.uniform()), angle = random.uniform(0.0, 2.0 * pi);
    const Eigen::Vector3d p(radius * std::cos(angle), radius * std::sin(angle),
                            random.uniform(cup_wall, 1.1 * cup_height));
    ASSERT_EQ(volume.depth_lower_bound(p.cast<float>()), -unbounded) << p.transpose();
    ASSERT_LE(volume.signed_distance(p.cast<float>()), 0.5F * volume.uncertainty()) << p.transpose();
  }
  EXPECT_GT(volume.depth_lower_bound({0, 0, static_cast<float>(cup_wall / 2)}), 0.0F) << "the cup's floor";
}

TEST(SolidVolume, OfAnOpenMeshHasNoInside) {
  Mesh mesh = sphere(0.05, 14);
  mesh.triangles.pop_back();
  mesh.triangles.erase(mesh.triangles.begin() + 100);
  const SolidVolume volume(mesh, margin);
  EXPECT_FALSE(volume.is_solid());
  EXPECT_EQ(volume.greatest_depth(), 0.0F);
  EXPECT_TRUE(volume.interior_samples().empty());
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f p = random_point(mesh.bounds(), random);
    ASSERT_EQ(volume.depth_lower_bound(p), -unbounded);
    ASSERT_LE(volume.signed_distance(p), 0.0F);
  }
}

TEST(SolidVolume, SamplesItsSurfaceAndItsInside) {
  for (const auto& [name, mesh] : solids()) {
    const SolidVolume volume(mesh, margin);
    const auto& samples = volume.surface_samples();
    Random random(4);
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3f p = random_surface_point(mesh, random);
      float nearest = unbounded;
      for (const Eigen::Vector3f& sample : samples) nearest = std::min(nearest, (sample - p).norm());
      ASSERT_LE(nearest, volume.sample_radius()) << name << " at " << p.transpose();
    }
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3f& sample = samples[random.below(samples.size())];
      ASSERT_LT(distance_to_surface(mesh, sample.cast<double>()), 1e-6) << name;
    }
    EXPECT_FALSE(volume.interior_samples().empty()) << name;
    for (std::size_t i = 0; i < volume.interior_samples().size(); i += 17)
      ASSERT_GT(true_depth(mesh, volume.interior_samples()[i].cast<double>()), -1e-6) << name;
  }
}

TEST(SolidVolume, IsTheSameForEveryExecutor) {
  const ThreadExecutor three(3);
  for (const auto& [name, mesh] : solids()) {
    const SolidVolume serial(mesh, margin), shared(mesh, margin, three);
    const SolidVolume::Field a = serial.field(), b = shared.field();
    const std::size_t voxels = static_cast<std::size_t>(a.size_x) * static_cast<std::size_t>(a.size_y) *
                               static_cast<std::size_t>(a.size_z);
    EXPECT_TRUE(std::equal(a.values, a.values + voxels, b.values)) << name;
    EXPECT_EQ(serial.surface_samples(), shared.surface_samples()) << name;
    EXPECT_EQ(serial.interior_samples(), shared.interior_samples()) << name;
    EXPECT_EQ(serial.greatest_depth(), shared.greatest_depth()) << name;
  }
}

TEST(SolidVolume, IsLeftUnfinishedWhenInterrupted) {
  StopCondition stop;
  stop.cancel();
  EXPECT_THROW(SolidVolume(cup(), margin, SerialExecutor(), stop), Interrupted);
}

TEST(SampleSurface, ComesCloseToEveryPoint) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const auto corner = [&](double scale) -> Eigen::Vector3f {
      return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).cast<float>() *
             static_cast<float>(scale);
    };
    Mesh mesh;
    mesh.vertices = {corner(1.0), corner(1.0)};
    mesh.vertices.push_back(mesh.vertices[0] +
                            corner(std::pow(10.0, random.uniform(-4.0, 0.0))));  // often a sliver
    mesh.triangles = {{0, 1, 2}};
    const float spacing = static_cast<float>(random.uniform(0.1, 3.0));
    const std::vector<Eigen::Vector3f> samples = sample_surface(mesh, spacing);
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3f p = random_surface_point(mesh, random);
      float nearest = unbounded;
      for (const Eigen::Vector3f& sample : samples) nearest = std::min(nearest, (sample - p).norm());
      ASSERT_LE(nearest, spacing / std::sqrt(3.0F) + 1e-6F) << "seed " << seed;
    }
  }
}

TEST(SolidVolume, IsRightOnLinesThroughVerticesAndEdges) {
  // All numbers are multiples of 2^-10 and so is the voxel's side: vertical lines through the voxels' centres
  // run exactly through vertices, along edges and within faces.
  constexpr float step = 1.0F / 1024.0F;
  constexpr int across = 72, cells = 6, cell = across / cells, border = 4;
  Mesh mesh;  // a box whose faces are grids with diagonals both ways
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, across})
      for (int i = 0; i < cells; ++i)
        for (int j = 0; j < cells; ++j) {
          const auto corner = [&](int di, int dj) {
            Eigen::Vector3f p;
            p(axis) = step * static_cast<float>(side);
            p((axis + 1) % 3) = step * static_cast<float>((i + di) * cell);
            p((axis + 2) % 3) = step * static_cast<float>((j + dj) * cell);
            mesh.vertices.push_back(p);
            return number(mesh.vertices.size() - 1);
          };
          std::array<std::uint32_t, 4> square{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (side == 0) std::reverse(square.begin(), square.end());
          std::rotate(square.begin(), square.begin() + (i + j) % 2, square.end());
          mesh.triangles.push_back({square[0], square[1], square[2]});
          mesh.triangles.push_back({square[0], square[2], square[3]});
        }
  const SolidVolume volume(mesh, border * step);
  ASSERT_TRUE(volume.is_solid());
  const Eigen::Vector3f middle = Eigen::Vector3f::Constant(step * across / 2);
  for (int k = -border; k <= across + border; ++k)
    for (int j = -border; j <= across + border; ++j)
      for (int i = -border; i <= across + border; ++i) {
        const Eigen::Vector3f p = step * Eigen::Vector3i(i, j, k).cast<float>();
        const Eigen::Vector3f beyond = (p - middle).cwiseAbs() - middle;
        const float outside = beyond.cwiseMax(0.0F).norm();
        const float depth = outside > 0.0F ? -outside : -beyond.maxCoeff();
        ASSERT_NEAR(volume.signed_distance(p), depth, 1e-6) << i << ", " << j << ", " << k;
      }
}

}  // namespace
}  // namespace perch
