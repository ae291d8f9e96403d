#include "perch/baselines/model_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace perch {
namespace {

/// Six times the volume that the triangles enclose; negative where they are turned inside out.
double signed_volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += static_cast<double>(mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])));
  return sum;
}

/// Points in cells of a side, to be found by their neighbours.
class CellGrid {
 public:
  explicit CellGrid(float side) : side_(side) {}

  void insert(const Eigen::Vector3f& point, std::size_t number) {
    cells_[key(cell(point))].push_back(number);
  }
  /// True for one of the points in this cell or beside it.
  template <typename Test>
  bool any_near(const Eigen::Vector3f& point, const Test& test) const {
    const Cell middle = cell(point);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          const auto found = cells_.find(key({middle.i + i, middle.j + j, middle.k + k}));
          if (found != cells_.end() && std::any_of(found->second.begin(), found->second.end(), test))
            return true;
        }
    return false;
  }

 private:
  struct Cell {
    std::int64_t i, j, k;
  };
  Cell cell(const Eigen::Vector3f& p) const {
    const auto of = [&](float x) { return static_cast<std::int64_t>(std::floor(x / side_)); };
    return {of(p.x()), of(p.y()), of(p.z())};
  }
  /// Cells that share a key are only looked at in vain.
  static std::uint64_t key(const Cell& c) {
    const auto bits = [](std::int64_t x) { return static_cast<std::uint64_t>(x) & 0x1fffffU; };
    return bits(c.i) << 42U | bits(c.j) << 21U | bits(c.k);
  }

  float side_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

}  // namespace

SurfaceSamples model_cloud(const Mesh& mesh, std::size_t points) {
  std::vector<double> area_up_to;
  double area = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector3f ab = mesh.vertices[b] - mesh.vertices[a], ac = mesh.vertices[c] - mesh.vertices[a];
    area += 0.5 * static_cast<double>(ab.cross(ac).norm());
    area_up_to.push_back(area);
  }
  SurfaceSamples samples;
  if (!(area > 0.0)) return samples;
  const float outwards = signed_volume(mesh) < 0.0 ? -1.0F : 1.0F;
  constexpr double step_s = 0.7548776662466927, step_t = 0.5698402909980532;  // R2's
  for (std::size_t i = 0; i < points; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(points) * area;
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end() - 1, at);
    const auto& [a, b, c] = mesh.triangles[static_cast<std::size_t>(found - area_up_to.begin())];
    const auto number = static_cast<double>(i + 1);
    auto s = static_cast<float>(number * step_s - std::floor(number * step_s)),
         t = static_cast<float>(number * step_t - std::floor(number * step_t));
    if (s + t > 1.0F) {  // the other half of the parallelogram
      s = 1.0F - s;
      t = 1.0F - t;
    }
    const Eigen::Vector3f ab = mesh.vertices[b] - mesh.vertices[a], ac = mesh.vertices[c] - mesh.vertices[a];
    const Eigen::Vector3f normal = ab.cross(ac);
    if (normal.norm() > 0.0F)
      samples.push_back(mesh.vertices[a] + s * ab + t * ac, outwards * normal.normalized());
  }
  return samples;
}

SurfaceSamples placed(const SurfaceSamples& samples, const Pose& pose, double origin_z) {
  const Eigen::Isometry3f transform = world_from_model(pose, origin_z).cast<float>();
  SurfaceSamples moved;
  for (std::size_t i = 0; i < samples.size(); ++i)
    moved.push_back(transform * samples.point(i), transform.linear() * samples.normal(i));
  return moved;
}

SurfaceSamples thinned(const SurfaceSamples& samples, float spacing) {
  constexpr float same_side = 0.8660254F;  // cosine of 30 degrees
  SurfaceSamples kept;
  CellGrid grid(spacing);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3f point = samples.point(i), normal = samples.normal(i);
    const auto close = [&](std::size_t other) {
      return (kept.point(other) - point).squaredNorm() < spacing * spacing &&
             kept.normal(other).dot(normal) > same_side;
    };
    if (grid.any_near(point, close)) continue;
    grid.insert(point, kept.size());
    kept.push_back(point, normal);
  }
  return kept;
}

}  // namespace perch
