#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "perch/core/random.hpp"
#include "perch/model/mesh.hpp"

// Shapes whose answers are known in closed form.
namespace perch::testing_verify {

/// A closed box with its lowest corner at `low`, metres; faces look outwards.
inline Mesh box(const Eigen::Vector3f& low, const Eigen::Vector3f& size) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(low +
                            size.cwiseProduct(Eigen::Vector3i(i & 1, (i >> 1) & 1, i >> 2).cast<float>()));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// A closed sphere about the origin of `rings` rings of twice as many quads; its vertices lie on the sphere.
inline Mesh sphere(double radius, std::uint32_t rings) {
  const std::uint32_t around = 2 * rings;
  Mesh mesh;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double polar = std::numbers::pi * i / rings, angle = 2.0 * std::numbers::pi * j / around;
      const bool pole = i == 0 || i == rings;
      mesh.vertices.push_back(
          (radius * Eigen::Vector3d(pole ? 0.0 : std::sin(polar) * std::cos(angle),
                                    pole ? 0.0 : std::sin(polar) * std::sin(angle), -std::cos(polar)))
              .cast<float>());
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t next = (j + 1) % around, a = i * around, b = a + around;
      if (i > 0) mesh.triangles.push_back({a + j, a + next, b + j});
      if (i + 1 < rings) mesh.triangles.push_back({a + next, b + next, b + j});
    }
  return mesh;
}

/// Triangles that lie anyhow, some of them slender, about 0.1 m across.
inline Mesh clutter(Random& random, std::size_t triangles) {
  const auto anywhere = [&](double scale) -> Eigen::Vector3f {
    return scale * Eigen::Vector3d(random.normal(), random.normal(), random.normal()).cast<float>();
  };
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Eigen::Vector3f a = anywhere(0.05), b = a + anywhere(0.04);
    mesh.vertices.insert(mesh.vertices.end(),
                         {a, b, b + anywhere(std::pow(10.0, random.uniform(-4.0, -1.5)))});
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

/// Turned at random.
inline Eigen::Isometry3d random_pose(Random& random, const Eigen::Vector3d& at) {
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Translation3d(at) * turn.normalized();
}

}  // namespace perch::testing_verify
