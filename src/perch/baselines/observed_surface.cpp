#include "perch/baselines/observed_surface.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace perch {
namespace {

constexpr int least_neighbours = 8;
constexpr int widest_window = 15;  // pixels to either side: what is seen from very near is smooth within them

std::optional<Eigen::Vector3f> normal_at(const Observation& observation, int u, int v, float radius) {
  const Intrinsics& camera = observation.intrinsics();
  const float depth = observation.depth(u, v);
  const Eigen::Vector3f middle = observation.rays().point(u, v, depth);
  const auto reach = [&](double focal) {
    return std::min(widest_window, static_cast<int>(std::ceil(focal * static_cast<double>(radius / depth))));
  };
  const int across = reach(camera.fx), down = reach(camera.fy);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  int n = 0;
  for (int y = std::max(0, v - down); y <= std::min(camera.height - 1, v + down); ++y)
    for (int x = std::max(0, u - across); x <= std::min(camera.width - 1, u + across); ++x) {
      const float z = observation.depth(x, y);
      if (!(z > 0.0F)) continue;
      const Eigen::Vector3f offset = observation.rays().point(x, y, z) - middle;
      if (offset.squaredNorm() > radius * radius) continue;
      sum += offset;
      squares += offset * offset.transpose();
      ++n;
    }
  if (n < least_neighbours) return std::nullopt;
  const Eigen::Vector3f mean = sum / static_cast<float>(n);
  const Eigen::Matrix3f covariance = squares / static_cast<float>(n) - mean * mean.transpose();
  const Eigen::Vector3f normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f>(covariance).eigenvectors().col(0);
  return normal.dot(middle) > 0.0F ? Eigen::Vector3f(-normal) : normal;
}

}  // namespace

SurfaceSamples observed_surface(const Observation& observation, double radius, const Executor& executor,
                                const StopCondition& stop) {
  const auto height = static_cast<std::size_t>(observation.intrinsics().height);
  std::vector<SurfaceSamples> rows(height);
  const Eigen::Isometry3f world_from_camera = observation.camera().world_from_camera.cast<float>();
  const auto fill_row = [&](std::size_t row, std::size_t) {
    const int v = static_cast<int>(row);
    for (std::size_t i = observation.row_begin(v); i < observation.row_begin(v + 1); ++i)
      if (const auto normal = normal_at(observation, observation.column(i), v, static_cast<float>(radius)))
        rows[row].push_back(world_from_camera * observation.points()[i],
                            world_from_camera.linear() * *normal);
  };
  if (!executor.for_each(height, fill_row, stop)) throw Interrupted();
  SurfaceSamples all;
  for (const SurfaceSamples& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) all.push_back(row.point(i), row.normal(i));
  return all;
}

}  // namespace perch
