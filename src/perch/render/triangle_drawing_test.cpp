// Several pixels and triangles at a time against one at a time, on every instruction set of this processor.

#include "perch/render/triangle_drawing.hpp"

#include <gtest/gtest.h>

#include "perch/core/random.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/render/reference_drawing_test_support.hpp"

namespace perch {
namespace {

constexpr InstructionSet instruction_sets[] = {InstructionSet::baseline, InstructionSet::x86_64_v3,
                                               InstructionSet::x86_64_v4};

class TriangleDrawingTest : public testing::Test {
 protected:
  void TearDown() override { use_instruction_set(InstructionSet::x86_64_v4); }
};

/// Triangles of many sizes, some slivers, some degenerate, some shared vertices on pixel centres; beyond the
/// near plane.
Mesh random_mesh(Random& random) {
  Mesh mesh;
  const std::size_t vertices = 3 + random.below(120);
  const double spread = random.uniform(0.01, 0.6), far = random.uniform(0.3, 2.0);
  const bool flat = random.below(5) == 0;
  for (std::size_t i = 0; i < vertices; ++i) {
    const double z = far + (flat ? 0.0 : random.uniform(-0.2, 0.2));
    Eigen::Vector3d p(random.uniform(-spread, spread), random.uniform(-spread, spread), z);
    if (random.below(4) == 0) {  // on a pixel centre
      p.x() = std::round(p.x() * 64.0) / 64.0;
      p.y() = std::round(p.y() * 64.0) / 64.0;
      p.z() = 1.0;
    }
    mesh.vertices.push_back(p.cast<float>());
  }
  const std::size_t triangles = random.below(400);
  const std::size_t near = 2 + random.below(vertices);
  for (std::size_t i = 0; i < triangles; ++i) {
    const std::size_t a = random.below(vertices);
    const auto other = [&] { return static_cast<std::uint32_t>((a + random.below(near)) % vertices); };
    mesh.triangles.push_back({static_cast<std::uint32_t>(a), other(), other()});
  }
  return mesh;
}

TEST_F(TriangleDrawingTest, EqualsOneAtATime) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const int width = 1 + static_cast<int>(random.below(90)), height = 1 + static_cast<int>(random.below(70));
    const double middle_u = width / 2, middle_v = height / 2;  // on a pixel centre
    const Intrinsics k{width, height, 64.0, 64.0, middle_u, middle_v};
    const Mesh mesh = random_mesh(random);
    const DepthPatch expected = reference_drawing(mesh, k);
    for (const InstructionSet set : instruction_sets) {
      use_instruction_set(set);
      const DepthPatch drawn = Rasterizer(k).render(mesh, Eigen::Isometry3d::Identity());
      for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u)
          ASSERT_EQ(drawn.at_or_none(u, v), expected.at(u, v)) << "pixel " << u << ", " << v;
    }
  }
}

// Also where triangles are clipped.
TEST_F(TriangleDrawingTest, IsTheSameOnAllInstructionSets) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const Intrinsics k{160, 120, 150.0, 140.0, 80.3, 58.9};
    const Mesh mesh = random_mesh(random);
    Eigen::Isometry3d pose(Eigen::AngleAxisd(random.uniform(-3, 3), Eigen::Vector3d(1, 2, 3).normalized()));
    pose.translation() =
        Eigen::Vector3d(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), random.uniform(-0.5, 1.0)) -
        pose.linear() * Eigen::Vector3d(0, 0, 1.0) + Eigen::Vector3d(0, 0, 1.0);
    use_instruction_set(InstructionSet::baseline);
    const DepthPatch expected = Rasterizer(k).render(mesh, pose);
    for (const InstructionSet set : instruction_sets) {
      use_instruction_set(set);
      const DepthPatch drawn = Rasterizer(k).render(mesh, pose);
      EXPECT_EQ(drawn.window, expected.window);
      EXPECT_EQ(drawn.depth, expected.depth);
    }
  }
}

}  // namespace
}  // namespace perch
