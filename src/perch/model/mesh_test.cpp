#include "perch/model/mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "perch/core/random.hpp"

namespace perch {
namespace {

using testing::HasSubstr;

/// A box from -1 to 1 in x, y and z.
Mesh box() {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(i & 1 ? 1.0F : -1.0F, i & 2 ? 1.0F : -1.0F, i & 4 ? 1.0F : -1.0F);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The same surface with three vertices of its own for every triangle.
Mesh with_repeated_vertices(const Mesh& mesh) {
  Mesh repeated;
  for (const auto& triangle : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(repeated.vertices.size());
    for (const std::uint32_t vertex : triangle) repeated.vertices.push_back(mesh.vertices[vertex]);
    repeated.triangles.push_back({first, first + 1, first + 2});
  }
  return repeated;
}

TEST(Mesh, StandsOnTheGround) {
  for (const float lift : {-3.5F, -1.0F, 0.0F, 1.0F, 7.25F}) {
    Mesh mesh = box();
    for (Eigen::Vector3f& p : mesh.vertices) p += Eigen::Vector3f(0.5F, -2.0F, lift);
    const Mesh stood = stood_on_ground(mesh);
    EXPECT_EQ(stood.bounds().min(), Eigen::Vector3f(-0.5F, -3.0F, 0.0F));
    EXPECT_EQ(stood.bounds().max(), Eigen::Vector3f(1.5F, -1.0F, 2.0F));
    EXPECT_EQ(stood.triangles, mesh.triangles);
  }
}

TEST(Mesh, NamesItsFault) {
  EXPECT_EQ(mesh_fault(box()), "");
  EXPECT_THAT(mesh_fault(Mesh{}), HasSubstr("no vertices"));
  Mesh mesh = box();
  mesh.triangles.clear();
  EXPECT_THAT(mesh_fault(mesh), HasSubstr("no triangles"));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
    for (int axis = 0; axis < 3; ++axis) {
      mesh = box();
      mesh.vertices[5](axis) = bad;
      EXPECT_THAT(mesh_fault(mesh), testing::AllOf(HasSubstr("not finite"), HasSubstr("5")));
    }
  for (const std::uint32_t beyond : {8U, std::numeric_limits<std::uint32_t>::max()}) {
    mesh = box();
    mesh.triangles[11][2] = beyond;
    EXPECT_THAT(mesh_fault(mesh),
                testing::AllOf(HasSubstr("11"), HasSubstr(std::to_string(beyond)), HasSubstr("8")));
  }
}

TEST(Mesh, IsClosedHoweverItsVerticesAreShared) {
  EXPECT_TRUE(is_closed(box()));
  EXPECT_TRUE(is_closed(with_repeated_vertices(box())));
  Mesh inside_out = box();
  for (auto& triangle : inside_out.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_TRUE(is_closed(inside_out));
}

TEST(Mesh, IsOpenWithoutOneOfItsTriangles) {
  for (std::size_t i = 0; i < 12; ++i) {
    Mesh mesh = box();
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(is_closed(mesh)) << i;
    EXPECT_FALSE(is_closed(with_repeated_vertices(mesh))) << i;
  }
  Mesh none = box();
  none.triangles.clear();
  EXPECT_FALSE(is_closed(none));
}

TEST(Mesh, IsNoSolidWithOneTriangleFlippedOrTwice) {
  for (std::size_t i = 0; i < 12; ++i) {
    Mesh flipped = box();
    std::swap(flipped.triangles[i][0], flipped.triangles[i][1]);
    EXPECT_FALSE(is_closed(flipped)) << i;
    EXPECT_FALSE(is_closed(with_repeated_vertices(flipped))) << i;
    Mesh twice = box();
    twice.triangles.push_back(twice.triangles[i]);
    EXPECT_FALSE(is_closed(twice)) << i;
  }
}

TEST(Mesh, IsASolidWhereFourTrianglesMeetAtAnEdge) {
  Mesh mesh = box();  // and a second box that touches it along one edge
  for (const Eigen::Vector3f& p : box().vertices) mesh.vertices.push_back(p + Eigen::Vector3f(2, 2, 0));
  for (const auto& [a, b, c] : box().triangles) mesh.triangles.push_back({a + 8, b + 8, c + 8});
  EXPECT_TRUE(is_closed(mesh));
  Mesh open = mesh;
  open.triangles.pop_back();
  EXPECT_FALSE(is_closed(open));
  for (std::size_t i = 8; i < 16; ++i) mesh.vertices[i].x() += 1.0F;
  EXPECT_TRUE(is_closed(mesh)) << "two boxes apart";
}

/// As the definition says, edge by edge.
bool every_edge_runs_both_ways(const Mesh& mesh) {
  std::vector<std::pair<Eigen::Vector3f, Eigen::Vector3f>> edges;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
    if (a == b || b == c || c == a) continue;
    edges.insert(edges.end(), {{a, b}, {b, c}, {c, a}});
  }
  return !edges.empty() && std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    return std::count(edges.begin(), edges.end(), edge) ==
           std::count(edges.begin(), edges.end(), std::pair(edge.second, edge.first));
  });
}

TEST(Mesh, IsClosedExactlyWhereEveryEdgeRunsBothWays) {
  int closed = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    Mesh mesh;  // a few tetrahedra on the corners of a small lattice, most of which touch
    for (std::size_t n = 1 + random.below(4); n > 0; --n) {
      const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
      const auto place = [&] { return static_cast<float>(random.below(2)); };
      for (int i = 0; i < 4; ++i) mesh.vertices.emplace_back(place(), place(), place());
      for (const auto& [a, b, c] : {std::array{0U, 2U, 1U}, {0U, 1U, 3U}, {1U, 2U, 3U}, {2U, 0U, 3U}})
        mesh.triangles.push_back({first + a, first + b, first + c});
    }
    if (random.below(2) == 0) {
      auto& triangle = mesh.triangles[random.below(mesh.triangles.size())];
      std::swap(triangle[0], triangle[random.below(3)]);
    }
    closed += is_closed(mesh);
    ASSERT_EQ(is_closed(mesh), every_edge_runs_both_ways(mesh)) << "seed " << seed;
  }
  EXPECT_GT(closed, 100);
  EXPECT_LT(closed, 250);
}

TEST(Mesh, MergesZerosOfEitherSign) {
  Mesh mesh = box();
  for (Eigen::Vector3f& p : mesh.vertices) p = (p.array() + 1.0F) / 2.0F;  // corners at 0 and 1
  mesh = with_repeated_vertices(mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 2)
    for (float& x : mesh.vertices[i].reshaped())
      if (x == 0.0F) x = -0.0F;
  EXPECT_TRUE(is_closed(mesh));
}

TEST(Mesh, IgnoresTrianglesWithoutArea) {
  Mesh mesh = box();
  mesh.triangles.push_back({3, 3, 5});
  mesh.triangles.push_back({2, 2, 2});
  EXPECT_TRUE(is_closed(mesh));
}

}  // namespace
}  // namespace perch
