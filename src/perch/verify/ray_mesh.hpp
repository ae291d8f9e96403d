#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace perch {

/// A mesh in some frame that rays can be cast at and distances be measured to, by Embree. Embree says which
/// triangles a ray meets, in float; where they are is for the caller, in double.
class RayMesh {
 public:
  using Triangles = std::span<const std::array<std::uint32_t, 3>>;

  /// Takes copies. \param vertices finite, metres.
  RayMesh(std::span<const Eigen::Vector3d> vertices, Triangles triangles);
  ~RayMesh();
  RayMesh(RayMesh&&) noexcept;
  RayMesh& operator=(RayMesh&&) noexcept;

  /// The first triangle on the ray origin + t direction with t >= t_min.
  std::optional<std::uint32_t> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                         double t_min) const;
  /// Every triangle that the ray meets at t >= 0, each once, ascending.
  std::vector<std::uint32_t> all_hits(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  /// From p to the nearest point of the mesh, metres; infinity for a mesh without triangles.
  double distance(const Eigen::Vector3d& p) const;
  /// True if the mesh comes as near as `radius` to p: distance(p) <= radius, for less work.
  bool is_within(const Eigen::Vector3d& p, double radius) const;

 private:
  struct Embree;
  std::unique_ptr<Embree> embree_;
};

}  // namespace perch
