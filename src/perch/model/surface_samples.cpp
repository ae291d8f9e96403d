#include "perch/model/surface_samples.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace perch {
namespace {

constexpr std::size_t parts = 16;  // of the triangles: tasks enough for the workers

/// Calls visit(point) for every sample of a triangle; the point's fourth number is 0.
template <typename Visit>
void for_each_sample(const Mesh& mesh, std::size_t triangle, float spacing, const Visit& visit) {
  const auto& [ia, ib, ic] = mesh.triangles[triangle];
  const Eigen::Vector3f &a = mesh.vertices[ia], &b = mesh.vertices[ib], &c = mesh.vertices[ic];
  const float longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  const int n = std::max(1, static_cast<int>(std::ceil(longest / spacing)));
  const float steps = static_cast<float>(n);
  const auto four = [](const Eigen::Vector3f& p) { return Eigen::Array4f(p.x(), p.y(), p.z(), 0.0F); };
  const Eigen::Array4f corner = four(a), ab = four(b - a), ac = four(c - a);
  for (int i = 0; i <= n; ++i) {
    const Eigen::Array4f row = corner + ab * (static_cast<float>(i) / steps);
    for (int j = 0; i + j <= n; ++j) visit(Eigen::Array4f(row + ac * (static_cast<float>(j) / steps)));
  }
}

}  // namespace

std::vector<Eigen::Vector3f> sample_surface(const Mesh& mesh, float spacing) {
  std::vector<Eigen::Vector3f> samples;
  for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle)
    for_each_sample(mesh, triangle, spacing,
                    [&](const Eigen::Array4f& p) { samples.emplace_back(p.head<3>()); });
  return samples;
}

std::vector<Eigen::Vector3f> mark_surface(const Mesh& mesh, float spacing, const VoxelGrid& grid,
                                          std::vector<float>& field, const Executor& executor,
                                          const StopCondition& stop) {
  struct First {
    std::size_t cell;
    Eigen::Vector3f point;
  };
  const std::size_t width = static_cast<std::size_t>(grid.size.x()), plane = grid.plane(),
                    cells_across = width / 2 + 1, cells_plane = cells_across * (grid.size.y() / 2 + 1),
                    cells = cells_plane * (grid.planes() / 2 + 1);
  const Eigen::Array4f origin(grid.origin.x(), grid.origin.y(), grid.origin.z(), 0.0F);
  std::vector<std::vector<First>> first_of_part(parts);
  const auto mark_part = [&](std::size_t part, std::size_t) {
    std::vector<char> taken(cells, 0);
    std::vector<First>& firsts = first_of_part[part];
    // By value, so that nothing is read again after what is written.
    const auto mark = [=, values = field.data(), cell_taken = taken.data(), voxel = grid.voxel,
                       &firsts](const Eigen::Array4f& p) {
      // The nearest: all numbers are positive.
      const Eigen::Array4f at = (p - origin) / voxel + 0.5F;
      const auto x = static_cast<std::size_t>(static_cast<int>(at[0])),
                 y = static_cast<std::size_t>(static_cast<int>(at[1])),
                 z = static_cast<std::size_t>(static_cast<int>(at[2]));
      // Others may set it at the same time, to the same.
      std::atomic_ref(values[z * plane + y * width + x]).store(0.0F, std::memory_order_relaxed);
      const std::size_t cell = z / 2 * cells_plane + y / 2 * cells_across + x / 2;
      if (!std::exchange(cell_taken[cell], 1)) firsts.push_back({cell, p.head<3>()});
    };
    const std::size_t first = part * mesh.triangles.size() / parts,
                      last = (part + 1) * mesh.triangles.size() / parts;
    for (std::size_t triangle = first; triangle < last; ++triangle)
      for_each_sample(mesh, triangle, spacing, mark);
  };
  if (!executor.for_each(parts, mark_part, stop)) throw Interrupted();

  std::vector<Eigen::Vector3f> samples;
  std::vector<char> taken(cells, 0);
  for (const auto& of_part : first_of_part)
    for (const First& first : of_part)
      if (!std::exchange(taken[first.cell], 1)) samples.push_back(first.point);
  return samples;
}

}  // namespace perch
