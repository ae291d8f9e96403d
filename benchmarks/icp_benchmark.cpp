// A round of ICP in (x, y, yaw), from the samples that are visible to the aligned pose, beside one
// written plainly on a k-d tree: the same weights, without the damping and the early ends.

#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "kd_tree.hpp"
#include "observed_mug.hpp"
#include "perch/refine/icp.hpp"
#include "perch/refine/surface_views.hpp"
#include "perch/refine/visible_samples.hpp"

namespace perch {
namespace {

constexpr double reach = 0.02;

/// The mug's own frame is the world's.
struct Alignment {
  ObservedMug mug;
  RefineSettings settings;
  Pose start{0.004, 0.003, 0.05};
  ObjectModel model{"mug", mug.mesh, Symmetry::none(), 0.0, 0.01};
  Observation observation{Camera{mug.camera.intrinsics, mug.pose.inverse()}, mug.depth, std::nullopt};
  Eigen::Vector3d eye = observation.camera().world_from_camera.translation();
  SurfaceViews views{model, eye.norm(), settings.samples};
  NearestTable table{observation, reach, SerialExecutor()};
  std::vector<Eigen::Vector3f> observed = world_points();
  KdTree tree{observed};
  SurfaceSamples samples;
  Sight sight;

  Pose by_table() {
    const SurfaceViews::View view = views.from(eye, start);
    visible_samples(view.samples, {start.x, start.y, view.yaw}, model.origin_z(), nullptr, observation,
                    settings.occlusion, samples, sight);
    return align(samples, start, false, table, reach, settings).pose;
  }

  /// Gauss-Newton on point-to-plane distances with the same weights, by homogeneous transforms, in double.
  Pose by_tree() const {
    const std::vector<Sample> visible = samples_in_view();
    Eigen::Isometry2d moved = Eigen::Isometry2d::Identity();  // of the samples, about the world's origin
    for (int iteration = 0; iteration < settings.iterations; ++iteration) {
      Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
      Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
      for (const Sample& sample : visible) {
        Eigen::Vector3d p = sample.point, n = sample.normal;
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

 private:
  struct Sample {
    Eigen::Vector3d point, normal;  ///< world frame
  };

  std::vector<Eigen::Vector3f> world_points() const {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3f& p : observation.points())
      points.push_back((observation.camera().world_from_camera * p.cast<double>()).cast<float>());
    return points;
  }

  std::vector<Sample> samples_in_view() const {
    const SurfaceViews::View view = views.from(eye, start);
    const Eigen::Isometry3d world_from_model = model.world_from_model({start.x, start.y, view.yaw});
    const Eigen::Isometry3d camera_from_world = observation.camera().world_from_camera.inverse();
    const Intrinsics& k = observation.intrinsics();
    std::vector<Sample> visible;
    for (std::size_t i = 0; i < view.samples.size(); ++i) {
      const Eigen::Vector3d p = world_from_model * view.samples.point(i).cast<double>();
      const Eigen::Vector3d seen = camera_from_world * p;
      const auto u = static_cast<int>(std::lround(k.fx * seen.x() / seen.z() + k.cx)),
                 v = static_cast<int>(std::lround(k.fy * seen.y() / seen.z() + k.cy));
      if (seen.z() <= 0.0 || u < 0 || v < 0 || u >= k.width || v >= k.height) continue;
      const double depth = static_cast<double>(observation.depth(u, v));
      if (depth > 0.0 && seen.z() - depth > settings.occlusion) continue;
      visible.push_back({p, world_from_model.linear() * view.samples.normal(i).cast<double>()});
    }
    return visible;
  }
};

/// As near as two searches come that take points up to a cell (5 mm) apart for the nearest.
bool near(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < 0.002 && std::abs(a.yaw - b.yaw) < 0.03;
}

void align_by_table(benchmark::State& state) {
  Alignment alignment;
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
