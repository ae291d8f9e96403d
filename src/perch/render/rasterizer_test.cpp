#include "perch/render/rasterizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// Powers of two, so that points at depths of a power of two project without rounding.
const Intrinsics camera{64, 48, 128.0, 128.0, 32.0, 24.0};
const Eigen::Isometry3d in_place = Eigen::Isometry3d::Identity();

/// The point that pixel (u, v) sees at this depth.
Eigen::Vector3f at(double u, double v, double depth, const Intrinsics& k = camera) {
  return Eigen::Vector3d((u - k.cx) / k.fx * depth, (v - k.cy) / k.fy * depth, depth).cast<float>();
}

std::uint32_t number(int i) {
  return static_cast<std::uint32_t>(i);
}

/// A surface of columns x rows cells, with the diagonals either way at random.
Mesh grid(int columns, int rows, Random& random, const std::function<Eigen::Vector3f(int, int)>& point) {
  Mesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) mesh.vertices.push_back(point(i, j));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t a = number(j * (columns + 1) + i), b = a + 1, c = a + number(columns + 1),
                          d = c + 1;
      if (random.below(2)) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      }
    }
  return mesh;
}

/// A rectangle parallel to the image whose edges lie on these columns and rows.
Mesh rectangle(double left, double top, double right, double bottom, double depth,
               const Intrinsics& k = camera) {
  Mesh mesh;
  mesh.vertices = {at(left, top, depth, k), at(right, top, depth, k), at(right, bottom, depth, k),
                   at(left, bottom, depth, k)};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// The smallest window that holds every covered pixel.
Window covered_window(const DepthPatch& patch) {
  Window window;
  for (int v = patch.window.v0; v < patch.window.v1; ++v)
    for (int u = patch.window.u0; u < patch.window.u1; ++u)
      if (patch.at(u, v) < no_surface) window = bounding(window, {u, v, u + 1, v + 1});
  return window;
}

TEST(Rasterizer, SamplesAtPixelCentres) {
  Rasterizer rasterizer(camera);
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const int u0 = static_cast<int>(random.below(60)), u1 = u0 + 1 + static_cast<int>(random.below(20));
    const int v0 = static_cast<int>(random.below(44)), v1 = v0 + 1 + static_cast<int>(random.below(20));
    const double depth = random.uniform(0.2, 3.0);
    // Each edge a little outside or inside the last pixel centre that it should take in, or exactly on it.
    const auto slack = [&] { return random.uniform(0.001, 0.999); };
    const bool exact = trial % 2 == 0;
    const double z = exact ? 1.0 : depth;
    const Mesh mesh = exact ? rectangle(u0, v0, u1, v1, z)
                            : rectangle(u0 - slack(), v0 - slack(), u1 + slack(), v1 + slack(), z);
    const DepthPatch patch = rasterizer.render(mesh, in_place);
    const Window expected = intersection({u0, v0, u1 + 1, v1 + 1}, camera.window());
    EXPECT_EQ(patch.covered(), static_cast<std::size_t>(expected.width() * expected.height()));
    EXPECT_EQ(covered_window(patch), expected) << "trial " << trial;
    EXPECT_EQ(patch.window, expected) << "trial " << trial;
    for (const float found : patch.depth) ASSERT_NEAR(found, z, 1e-6 * z) << "trial " << trial;
  }
}

TEST(Rasterizer, MissesWhatLiesBetweenPixelCentres) {
  Rasterizer rasterizer(camera);
  EXPECT_EQ(rasterizer.render(rectangle(10.001, 5.0, 10.999, 9.0, 1.0), in_place).covered(), 0U);
  EXPECT_EQ(rasterizer.render(rectangle(9.999, 5.001, 10.001, 5.999, 1.0), in_place).covered(), 0U);
}

TEST(Rasterizer, FollowsATiltedPlaneSeenFromEitherSide) {
  const Intrinsics k{320, 240, 300.0, 310.0, 158.3, 121.7};
  Rasterizer rasterizer(k);
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const Eigen::Vector3d normal(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), -1.0);
    const double offset = -random.uniform(0.3, 3.0);
    const auto depth = [&](double u, double v) {
      return offset / normal.dot(Eigen::Vector3d((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0));
    };
    Mesh mesh;
    for (int i = 0; i < 3; ++i) {
      const double u = random.uniform(-100, 420), v = random.uniform(-100, 340);
      mesh.vertices.push_back(at(u, v, depth(u, v), k));
    }
    mesh.triangles = {{0, 1, 2}};
    const DepthPatch front = rasterizer.render(mesh, in_place);
    for (int v = front.window.v0; v < front.window.v1; ++v)
      for (int u = front.window.u0; u < front.window.u1; ++u)
        if (front.at(u, v) < no_surface) {
          ASSERT_NEAR(front.at(u, v), depth(u, v), 2e-6 * depth(u, v)) << "seed " << seed;
        }
    mesh.triangles = {{0, 2, 1}};
    const DepthPatch back = rasterizer.render(mesh, in_place);
    EXPECT_EQ(back.window, front.window) << "seed " << seed;
    EXPECT_EQ(back.depth, front.depth) << "seed " << seed;
  }
}

TEST(Rasterizer, FollowsASphere) {
  const Intrinsics k{320, 240, 300.0, 300.0, 159.5, 119.5};
  constexpr double radius = 0.1, pi = std::numbers::pi;
  constexpr int rings = 200;
  Random random(4);
  const Mesh mesh = grid(2 * rings, rings, random, [&](int i, int j) -> Eigen::Vector3f {
    const double a = pi * i / rings, b = pi * j / rings;
    return Eigen::Vector3d(std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b)).cast<float>() *
           static_cast<float>(radius);
  });
  const Eigen::Vector3d centre(0.03, -0.02, 0.5);
  const DepthPatch patch = Rasterizer(k).render(mesh, Eigen::Isometry3d(Eigen::Translation3d(centre)));
  // How far the flat facets lie inside the sphere; along a slanting ray that counts for more.
  const double sagitta = radius * (1.0 - std::pow(std::cos(pi / rings / 2.0), 2.0));
  int well_inside = 0;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const Eigen::Vector3d ray((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0);
      const double b = ray.dot(centre) / ray.squaredNorm();
      const double distance = (b * ray - centre).norm();
      if (distance > radius) {
        EXPECT_EQ(patch.at_or_none(u, v), no_surface);
      }
      if (distance > 0.9 * radius) continue;
      const double half_chord = std::sqrt(radius * radius - distance * distance);
      const double depth = b - half_chord / ray.norm();
      const double lag = patch.at_or_none(u, v) - depth;
      ASSERT_GT(lag, -1e-6) << u << ", " << v;
      ASSERT_LT(lag, sagitta * radius / half_chord + 1e-6) << u << ", " << v;
      ++well_inside;
    }
  EXPECT_GT(well_inside, 5000);
}

TEST(Rasterizer, LeavesNoCracks) {
  const Intrinsics k{640, 480, 525.0, 525.0, 319.5, 239.5};
  Rasterizer rasterizer(k);
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    const int cells = 20 + static_cast<int>(random.below(200));
    const Eigen::Vector3d normal(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), -1.0);
    const double turn = random.uniform(0.0, 6.3), size = 1000.0;
    const Mesh mesh = grid(cells, cells, random, [&](int i, int j) -> Eigen::Vector3f {
      const double s = size * (i / (0.5 * cells) - 1.0), t = size * (j / (0.5 * cells) - 1.0);
      const double u = k.cx + std::cos(turn) * s - std::sin(turn) * t,
                   v = k.cy + std::sin(turn) * s + std::cos(turn) * t;
      const double slope = normal.dot(Eigen::Vector3d((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0));
      return at(u, v, 1.0 / std::max(0.05, -slope), k);
    });
    EXPECT_EQ(rasterizer.render(mesh, in_place).covered(), 640U * 480U) << "seed " << seed;
  }
}

TEST(Rasterizer, LeavesNoCracksWhereVerticesFallOnPixelCentres) {
  Rasterizer rasterizer(camera);
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const int step = 1 + static_cast<int>(random.below(7));
    const auto inner = [&](int i) { return i * step - 8; };
    const Mesh mesh = grid(80 / step + 1, 64 / step + 1, random, [&](int i, int j) -> Eigen::Vector3f {
      return at(inner(i), inner(j), std::exp2(static_cast<double>(random.below(4)) - 2.0));
    });
    EXPECT_EQ(rasterizer.render(mesh, in_place).covered(), 64U * 48U) << "seed " << seed;
  }
}

TEST(Rasterizer, LeavesNoCracksWhereEdgesPassThroughPixelCentres) {
  // Two triangles whose common edge passes through a pixel centre up to rounding: one of them has to take it.
  Rasterizer rasterizer(camera);
  DepthPatch patch;
  Random random(6);
  for (int trial = 0; trial < 50000; ++trial) {
    const int u = static_cast<int>(random.below(64)), v = static_cast<int>(random.below(48));
    const double angle = random.uniform(0.0, 6.3), du = std::cos(angle), dv = std::sin(angle);
    const double ahead = random.uniform(3.0, 90.0), behind = random.uniform(3.0, 90.0),
                 aside = random.uniform(3.0, 90.0);
    Mesh mesh;
    mesh.vertices = {at(u + ahead * du, v + ahead * dv, 1.0), at(u - behind * du, v - behind * dv, 1.0),
                     at(u + aside * dv, v - aside * du, 1.0), at(u - aside * dv, v + aside * du, 1.0)};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
    if (trial % 2) mesh.triangles[1] = {3, 0, 1};
    rasterizer.render(mesh, in_place, patch);
    ASSERT_LT(patch.at_or_none(u, v), no_surface) << "trial " << trial << ", pixel " << u << ", " << v;
  }
}

TEST(Rasterizer, ClipsAFloorThatPassesUnderTheCamera) {
  const Intrinsics k{320, 240, 250.0, 250.0, 159.5, 119.5};
  constexpr double height = 0.4, reach = 6.0;
  for (const double pitch : {0.0, 0.2, 0.5, 1.2}) {
    // The camera looks along world x, turned down by `pitch`.
    Eigen::Matrix3d axes;  // columns: the camera's x, y, z in the world
    axes.col(0) << 0, -1, 0;
    axes.col(1) << -std::sin(pitch), 0, -std::cos(pitch);
    axes.col(2) << std::cos(pitch), 0, -std::sin(pitch);
    Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
    world_from_camera.linear() = axes;
    world_from_camera.translation().z() = height;
    for (const int cells : {1, 7, 40}) {
      Random random(5);
      const Mesh floor = grid(cells, cells, random, [&](int i, int j) -> Eigen::Vector3f {
        return Eigen::Vector3d(reach * (2.0 * i / cells - 1.0), reach * (2.0 * j / cells - 1.0), 0.0)
            .cast<float>();
      });
      const DepthPatch patch = Rasterizer(k).render(floor, world_from_camera.inverse());
      int checked = 0;
      for (int v = 0; v < k.height; ++v)
        for (int u = 0; u < k.width; ++u) {
          const Eigen::Vector3d ray = axes * Eigen::Vector3d((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1.0);
          if (ray.z() >= 0.0) {
            ASSERT_EQ(patch.at_or_none(u, v), no_surface) << "above the horizon, " << u << ", " << v;
            continue;
          }
          const double depth = -height / ray.z();
          if (depth * ray.head<2>().lpNorm<Eigen::Infinity>() > 0.98 * reach) continue;
          ASSERT_NEAR(patch.at_or_none(u, v), depth, 2e-5 * depth)
              << "pitch " << pitch << ", cells " << cells << ", pixel " << u << ", " << v;
          ++checked;
        }
      EXPECT_GT(checked, 10000) << "pitch " << pitch;
    }
  }
}

TEST(Rasterizer, CutsOffWhatIsNearerThanTheNearPlane) {
  Rasterizer rasterizer(camera);
  constexpr double near_plane = Rasterizer::near_plane;
  EXPECT_EQ(rasterizer.render(rectangle(-5, -5, 70, 60, near_plane * 0.99), in_place).covered(), 0U);
  EXPECT_EQ(rasterizer.render(rectangle(-5, -5, 70, 60, near_plane * 1.01), in_place).covered(), 64U * 48U);
}

TEST(Rasterizer, IsEmptyWhereNothingIsInView) {
  Rasterizer rasterizer(camera);
  const Mesh mesh = rectangle(10, 10, 20, 20, 1.0);
  for (const Eigen::Vector3d& shift :
       {Eigen::Vector3d(2, 0, 0), Eigen::Vector3d(-2, 0, 0), Eigen::Vector3d(0, 2, 0),
        Eigen::Vector3d(0, -2, 0), Eigen::Vector3d(0, 0, -3), Eigen::Vector3d(0, 0, -1)}) {
    const DepthPatch patch = rasterizer.render(mesh, Eigen::Isometry3d(Eigen::Translation3d(shift)));
    EXPECT_TRUE(patch.window.empty()) << shift.transpose();
    EXPECT_TRUE(patch.depth.empty()) << shift.transpose();
    EXPECT_EQ(patch.covered(), 0U);
  }
  EXPECT_TRUE(rasterizer.render(Mesh{}, in_place).window.empty());
}

/// Triangles anywhere around the camera, some behind it.
Mesh scattered_triangles(Random& random) {
  Mesh mesh;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector3d middle(random.normal(), random.normal(), random.uniform(-0.2, 2.0));
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(
          (middle + 0.2 * Eigen::Vector3d(random.normal(), random.normal(), random.normal())).cast<float>());
    mesh.triangles.push_back({number(3 * i), number(3 * i + 1), number(3 * i + 2)});
  }
  return mesh;
}

TEST(Rasterizer, KeepsItsWindowInTheImageAndReusesAPatch) {
  Rasterizer rasterizer(camera);
  DepthPatch reused;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const Mesh mesh = scattered_triangles(random);
    rasterizer.render(mesh, in_place, reused);
    const DepthPatch fresh = Rasterizer(camera).render(mesh, in_place);
    EXPECT_EQ(reused.window, fresh.window) << "seed " << seed;
    EXPECT_EQ(reused.depth, fresh.depth) << "seed " << seed;
    EXPECT_EQ(intersection(reused.window, camera.window()), reused.window) << "seed " << seed;
    EXPECT_EQ(reused.depth.size(), reused.window.empty() ? 0U
                                                         : static_cast<std::size_t>(reused.window.width() *
                                                                                    reused.window.height()));
  }
}

TEST(Rasterizer, DrawsAnyPartOfAnImageAlike) {
  // A camera that sees only a part of another's image sees there what the other sees.
  for (const Window& part :
       {Window{30, 20, 31, 21}, Window{28, 22, 35, 27}, Window{0, 0, 64, 1}, Window{63, 0, 64, 48}}) {
    const Intrinsics small{part.width(), part.height(),       camera.fx,
                           camera.fy,    camera.cx - part.u0, camera.cy - part.v0};
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      Random random(seed);
      const Mesh mesh = scattered_triangles(random);
      const DepthPatch whole = Rasterizer(camera).render(mesh, in_place);
      const DepthPatch cut = Rasterizer(small).render(mesh, in_place);
      for (int v = part.v0; v < part.v1; ++v)
        for (int u = part.u0; u < part.u1; ++u) {
          const float expected = whole.at_or_none(u, v), found = cut.at_or_none(u - part.u0, v - part.v0);
          if (expected == no_surface) {
            ASSERT_EQ(found, no_surface) << "seed " << seed << ", pixel " << u << ", " << v;
          } else {
            ASSERT_NEAR(found, expected, 1e-5 * expected) << "seed " << seed << ", pixel " << u << ", " << v;
          }
        }
    }
  }
}

}  // namespace
}  // namespace perch
