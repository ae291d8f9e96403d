// ICP in (x, y, yaw), beside the same written plainly on a k-d tree.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "kd_tree.hpp"
#include "observed_mug.hpp"
#include "perch/refine/icp.hpp"

namespace perch {
namespace {

constexpr double reach = 0.02;

struct Alignment {
  ObservedMug mug;
  RefineSettings settings;
  Pose start{0.003, 0.0, 0.0};
  NearestTable table{mug.observation, reach, SerialExecutor()};
  KdTree tree{mug.observation.points()};
  std::vector<SurfaceSample> samples;

  Alignment() { sample_patch(mug.rendered, nullptr, mug.observation, settings, samples); }

  Pose by_table() const { return align(samples, start, false, table, reach, settings); }

  /// Gauss-Newton on point-to-plane distances with the same weights, by homogeneous transforms, in double.
  Pose by_tree() const {
    const auto& observed = mug.observation.points();
    Eigen::Isometry2d moved = Eigen::Isometry2d::Identity();  // of the samples, about the world's origin
    for (int iteration = 0; iteration < settings.iterations; ++iteration) {
      Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      for (const SurfaceSample& sample : samples) {
        Eigen::Vector3d p = sample.point.cast<double>(), n = sample.normal.cast<double>();
        p.head<2>() = moved * p.head<2>();
        n.head<2>() = moved.linear() * n.head<2>();
        const KdTree::Neighbour neighbour = tree.nearest(p.cast<float>());
        if (neighbour.squared_distance > reach * reach) continue;
        const double e = n.dot(p - observed[neighbour.number].cast<double>());
        const double weight = 1.0 / (1.0 + std::abs(e) / settings.robust_scale);
        const Eigen::Vector3d jacobian(n.x(), n.y(), n.y() * p.x() - n.x() * p.y());
        normal_matrix += weight * jacobian * jacobian.transpose();
        gradient += weight * e * jacobian;
      }
      const Eigen::Vector3d step = -normal_matrix.ldlt().solve(gradient);
      moved = Eigen::Translation2d(step.head<2>()) * Eigen::Rotation2Dd(step.z()) * moved;
      if (step.head<2>().norm() < 5e-5) break;
    }
    const Eigen::Vector2d origin = moved * Eigen::Vector2d(start.x, start.y);
    return {origin.x(), origin.y(), start.yaw + Eigen::Rotation2Dd(moved.linear()).angle()};
  }
};

bool near(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < 0.0005 && std::abs(a.yaw - b.yaw) < 0.01;
}

void align_by_table(benchmark::State& state) {
  const Alignment alignment;
  if (!near(alignment.by_table(), alignment.by_tree())) state.SkipWithError("the poses are not the same");
  for (auto _ : state) benchmark::DoNotOptimize(alignment.by_table());
}
BENCHMARK(align_by_table)->Name("icp/kernel")->Unit(benchmark::kMicrosecond);

void align_by_tree(benchmark::State& state) {
  const Alignment alignment;
  for (auto _ : state) benchmark::DoNotOptimize(alignment.by_tree());
}
BENCHMARK(align_by_tree)->Name("icp/k-d tree")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace perch
