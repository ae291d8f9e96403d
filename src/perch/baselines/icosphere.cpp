#include "perch/baselines/icosphere.hpp"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

namespace perch {
namespace {

Icosphere icosahedron() {
  constexpr double a = 1.0, b = std::numbers::phi;
  Icosphere sphere;
  sphere.vertices = {{-a, b, 0.0},  {a, b, 0.0},  {-a, -b, 0.0}, {a, -b, 0.0}, {0.0, -a, b},  {0.0, a, b},
                     {0.0, -a, -b}, {0.0, a, -b}, {b, 0.0, -a},  {b, 0.0, a},  {-b, 0.0, -a}, {-b, 0.0, a}};
  sphere.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Eigen::Vector3d& vertex : sphere.vertices) vertex.normalize();
  return sphere;
}

}  // namespace

Icosphere icosphere(int subdivisions) {
  Icosphere sphere = icosahedron();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(i, j), static_cast<std::uint32_t>(sphere.vertices.size()));
      if (is_new) sphere.vertices.push_back((sphere.vertices[i] + sphere.vertices[j]).normalized());
      return place->second;
    };
    std::vector<std::array<std::uint32_t, 3>> split;
    split.reserve(4 * sphere.triangles.size());
    for (const auto& [i, j, k] : sphere.triangles) {
      const std::uint32_t ij = middle(i, j), jk = middle(j, k), ki = middle(k, i);
      split.insert(split.end(), {{i, ij, ki}, {j, jk, ij}, {k, ki, jk}, {ij, jk, ki}});
    }
    sphere.triangles = std::move(split);
  }
  return sphere;
}

}  // namespace perch
