#include "perch/sim/mesh_builder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace perch {
namespace {

using std::numbers::pi;

std::uint32_t add_vertex(Mesh& mesh, const Eigen::Vector3d& point) {
  mesh.vertices.push_back(point.cast<float>());
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

}  // namespace

Mesh loft(const std::vector<std::vector<Eigen::Vector3d>>& rings) {
  Mesh mesh;
  std::vector<std::uint32_t> previous;
  for (const auto& ring : rings) {
    std::vector<std::uint32_t> current;
    for (const Eigen::Vector3d& point : ring) current.push_back(add_vertex(mesh, point));
    const std::size_t n = std::max(previous.size(), current.size());
    for (std::size_t k = 0; !previous.empty() && k < n; ++k) {
      const std::size_t next = (k + 1) % n;
      if (previous.size() == 1) {
        mesh.triangles.push_back({previous[0], current[next], current[k]});
      } else if (current.size() == 1) {
        mesh.triangles.push_back({previous[k], previous[next], current[0]});
      } else {
        mesh.triangles.push_back({previous[k], previous[next], current[next]});
        mesh.triangles.push_back({previous[k], current[next], current[k]});
      }
    }
    previous = std::move(current);
  }
  return mesh;
}

Mesh revolve(std::span<const ProfilePoint> profile, int segments, const Section& section) {
  std::vector<std::vector<Eigen::Vector3d>> rings;
  for (const auto& [radius, z] : profile) {
    std::vector<Eigen::Vector3d>& ring = rings.emplace_back();
    if (radius == 0.0) {
      ring.emplace_back(0.0, 0.0, z);
      continue;
    }
    for (int k = 0; k < segments; ++k) {
      const double angle = 2.0 * pi * k / segments;
      const double r = section ? radius * section(angle, z) : radius;
      ring.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
  }
  return loft(rings);
}

Section polygon_section(int n) {
  return [n](double angle, double) {
    const double side = 2.0 * pi / n;
    // Measured from the nearest corner, so that corners come out as exactly 1.
    const double from_corner = std::abs(std::remainder(angle, side));
    return std::cos(side / 2) / std::cos(side / 2 - from_corner);
  };
}

Profile rounded(std::span<const ProfilePoint> profile, double reach, int steps) {
  Profile smooth{profile.front()};
  for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
    const Eigen::Vector2d corner(profile[i].radius, profile[i].z);
    const auto towards = [&](const ProfilePoint& neighbour) -> Eigen::Vector2d {
      const Eigen::Vector2d side = Eigen::Vector2d(neighbour.radius, neighbour.z) - corner;
      return corner + side * std::min(0.5, reach / side.norm());
    };
    const Eigen::Vector2d from = towards(profile[i - 1]), to = towards(profile[i + 1]);
    for (int s = 0; s <= steps; ++s) {  // a quadratic Bezier curve
      const double t = static_cast<double>(s) / steps;
      const Eigen::Vector2d p = (1 - t) * (1 - t) * from + 2 * t * (1 - t) * corner + t * t * to;
      const Eigen::Vector2d last(smooth.back().radius, smooth.back().z);
      if ((p - last).norm() > 1e-7) smooth.push_back({p.x(), p.y()});  // half sides meet half way
    }
  }
  smooth.push_back(profile.back());
  return smooth;
}

Profile subdivided(std::span<const ProfilePoint> profile, double spacing) {
  Profile fine{profile.front()};
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const ProfilePoint &a = profile[i - 1], &b = profile[i];
    const bool on_axis = a.radius == 0.0 || b.radius == 0.0;
    const double length = std::hypot(b.radius - a.radius, b.z - a.z);
    const int n = on_axis ? 1 : std::max(1, static_cast<int>(std::ceil(length / spacing - 1e-9)));
    for (int k = 1; k < n; ++k)
      fine.push_back({a.radius + (b.radius - a.radius) * k / n, a.z + (b.z - a.z) * k / n});
    fine.push_back(b);
  }
  return fine;
}

Mesh box(const Eigen::Vector3d& size, double cell) {
  using Node = std::array<int, 3>;  // a corner of the cells, counted along the axes
  Node cells;
  for (std::size_t a = 0; a < 3; ++a)
    cells[a] = std::max(1, static_cast<int>(std::ceil(size[static_cast<int>(a)] / cell - 1e-9)));
  Mesh mesh;
  std::map<Node, std::uint32_t> numbers;
  const auto vertex = [&](const Node& node) {
    const auto [found, added] = numbers.try_emplace(node, 0);
    if (added)
      found->second = add_vertex(mesh, {size.x() * (static_cast<double>(node[0]) / cells[0] - 0.5),
                                        size.y() * (static_cast<double>(node[1]) / cells[1] - 0.5),
                                        size.z() * (static_cast<double>(node[2]) / cells[2])});
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t right = (axis + 1) % 3, up = (axis + 2) % 3;  // right x up = axis
    for (const bool far : {false, true})
      for (int i = 0; i < cells[right]; ++i)
        for (int j = 0; j < cells[up]; ++j) {
          const auto corner = [&](int di, int dj) {
            Node node;
            node[axis] = far ? cells[axis] : 0;
            node[right] = i + di;
            node[up] = j + dj;
            return vertex(node);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (far) {
            mesh.triangles.push_back({a, b, c});
            mesh.triangles.push_back({a, c, d});
          } else {
            mesh.triangles.push_back({a, c, b});
            mesh.triangles.push_back({a, d, c});
          }
        }
  }
  return mesh;
}

Mesh tube(std::span<const Eigen::Vector2d> path_xz, double half_width, double half_thickness, int segments) {
  const auto point = [&](std::size_t i) { return Eigen::Vector3d(path_xz[i].x(), 0.0, path_xz[i].y()); };
  const std::size_t last = path_xz.size() - 1;
  std::vector<std::vector<Eigen::Vector3d>> rings{{point(0)}};
  for (std::size_t i = 0; i <= last; ++i) {
    const Eigen::Vector3d tangent = (point(std::min(i + 1, last)) - point(i == 0 ? 0 : i - 1)).normalized();
    const Eigen::Vector3d across = Eigen::Vector3d::UnitY().cross(tangent);  // across x y = tangent
    std::vector<Eigen::Vector3d>& ring = rings.emplace_back();
    for (int k = 0; k < segments; ++k) {
      const double angle = 2.0 * pi * k / segments;
      ring.push_back(point(i) + half_thickness * std::cos(angle) * across +
                     half_width * std::sin(angle) * Eigen::Vector3d::UnitY());
    }
  }
  rings.push_back({point(last)});
  return loft(rings);
}

Mesh moved(Mesh mesh, const Eigen::Isometry3d& transform) {
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex = (transform * vertex.cast<double>()).cast<float>();
  return mesh;
}

Mesh scaled(Mesh mesh, const Eigen::Vector3d& factors) {
  for (Eigen::Vector3f& vertex : mesh.vertices)
    vertex = vertex.cast<double>().cwiseProduct(factors).cast<float>();
  return mesh;
}

Mesh merged(const std::vector<Mesh>& parts) {
  Mesh whole;
  for (const Mesh& part : parts) {
    const auto first = static_cast<std::uint32_t>(whole.vertices.size());
    whole.vertices.insert(whole.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const auto& [a, b, c] : part.triangles) whole.triangles.push_back({first + a, first + b, first + c});
  }
  return whole;
}

double signed_volume(const Mesh& mesh) {
  double six_volumes = 0.0;
  for (const auto& [a, b, c] : mesh.triangles)
    six_volumes += mesh.vertices[a].cast<double>().dot(
        mesh.vertices[b].cast<double>().cross(mesh.vertices[c].cast<double>()));
  return six_volumes / 6.0;
}

}  // namespace perch
