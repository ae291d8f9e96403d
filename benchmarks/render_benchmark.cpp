// Drawing one object into its window, beside one triangle and one pixel at a time. The image is hardly larger
// than the object's window: the plain drawing fills all of it.

#include <benchmark/benchmark.h>

#include "perch/core/instruction_set.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/render/reference_drawing_test_support.hpp"
#include "perch/sim/parametric_models.hpp"
#include "scene_variants.hpp"

namespace perch {
namespace {

/// A can 0.8 m away, seen from above.
struct PlacedCan {
  Intrinsics intrinsics{96, 96, 525.0, 525.0, 47.5, 47.5};
  Mesh mesh;  ///< camera frame
  Rasterizer rasterizer{intrinsics};

  explicit PlacedCan(std::int64_t triangles)
      : mesh(with_triangles(can_mesh(), static_cast<std::size_t>(triangles))) {
    const Eigen::Isometry3f camera_from_model =
        Eigen::Translation3f(0.0F, 0.03F, 0.8F) * Eigen::AngleAxisf(2.2F, Eigen::Vector3f::UnitX());
    for (Eigen::Vector3f& p : mesh.vertices) p = camera_from_model * p;
  }
};

bool same(const DepthPatch& patch, const DepthPatch& whole) {
  for (int v = whole.window.v0; v < whole.window.v1; ++v)
    for (int u = whole.window.u0; u < whole.window.u1; ++u)
      if (patch.at_or_none(u, v) != whole.at(u, v)) return false;
  return patch.any();
}

void render(benchmark::State& state, InstructionSet set) {
  PlacedCan can(state.range(0));
  use_instruction_set(set);
  DepthPatch patch;
  can.rasterizer.render(can.mesh, Eigen::Isometry3d::Identity(), patch);
  if (!same(patch, reference_drawing(can.mesh, can.intrinsics)))
    state.SkipWithError("the images are not the same");
  for (auto _ : state) {
    can.rasterizer.render(can.mesh, Eigen::Isometry3d::Identity(), patch);
    benchmark::DoNotOptimize(patch.depth.data());
  }
  use_instruction_set(InstructionSet::x86_64_v4);
}

void draw_plainly(benchmark::State& state) {
  const PlacedCan can(state.range(0));
  for (auto _ : state) {
    const DepthPatch patch = reference_drawing(can.mesh, can.intrinsics);
    benchmark::DoNotOptimize(patch.depth.data());
  }
}

void sizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("triangles")->Arg(2000)->Arg(16000)->Unit(benchmark::kMicrosecond);
}
BENCHMARK_CAPTURE(render, , InstructionSet::x86_64_v4)->Name("render/kernel")->Apply(sizes);
BENCHMARK_CAPTURE(render, , InstructionSet::x86_64_v3)->Name("render/x86-64-v3")->Apply(sizes);
BENCHMARK_CAPTURE(render, , InstructionSet::baseline)->Name("render/x86-64")->Apply(sizes);
BENCHMARK(draw_plainly)->Name("render/plain")->Apply(sizes);

}  // namespace
}  // namespace perch
