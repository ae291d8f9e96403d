#include "perch/verify/sightings.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>

#include "perch/verify/ray_mesh.hpp"

namespace perch {
namespace {

constexpr double infinite_depth = std::numeric_limits<double>::infinity();
/// What single precision loses in a vertex's coordinates on its way from the model's frame to the camera's,
/// of how far it is from the model's origin and that from the camera.
constexpr double point_rounding = 3e-7;
/// What it loses in a place in the image, of coordinates as large as that.
constexpr double image_rounding = 3e-7;
/// What it loses in the depth that a triangle's plane has at a pixel, of that depth, for a plane that is seen
/// squarely and a triangle with a right angle.
constexpr double plane_rounding = 1e-6;

/// A triangle one of whose sides runs within `radius` pixels of a pixel's centre.
struct Brush {
  std::uint32_t pixel, triangle;
  double radius;
};

/// One object before the camera.
class ObjectSight {
 public:
  ObjectSight(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model, const Intrinsics& k,
              std::uint32_t object)
      : mesh_(mesh), k_(k), object_(object) {
    const double distance = camera_from_model.translation().norm();
    for (const Eigen::Vector3f& p : mesh.vertices) {
      vertices_.push_back(camera_from_model * p.cast<double>());
      errors_.push_back(point_rounding * (static_cast<double>(p.norm()) + distance));
    }
  }

  std::vector<Sighting> look() {
    find_window();
    if (window_.empty()) return {};
    const RayMesh rays(vertices_, mesh_.triangles);
    find_brushes();
    auto brush = brushes_.begin();
    for (int v = window_.v0; v < window_.v1; ++v)
      for (int u = window_.u0; u < window_.u1; ++u) {
        const auto pixel = static_cast<std::uint32_t>(v * k_.width + u);
        auto end = brush;
        while (end != brushes_.end() && end->pixel == pixel) ++end;
        if (brush == end)
          look_inside(rays, pixel, u, v);
        else
          look_at_edges(rays, pixel, u, v, {&*brush, static_cast<std::size_t>(end - brush)});
        brush = end;
      }
    return std::move(seen_);
  }

 private:
  void find_window() {
    constexpr double farthest = 1e6;  // metres; beyond it single precision has no use for pixels
    Eigen::Array2d low = Eigen::Array2d::Constant(infinite_depth), high = -low;
    bool crosses_near = false;
    for (const Eigen::Vector3d& p : vertices_) {
      if (!(p.cwiseAbs().maxCoeff() < farthest)) return;
      if (p.z() < sight_near_plane) {
        crosses_near = true;
        continue;
      }
      low = low.min(project(p));
      high = high.max(project(p));
    }
    if (!(low.x() <= high.x())) return;
    window_ = k_.window();
    if (crosses_near) return;
    const auto pixel = [](double x, int limit) {
      return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(limit) + 1.0));
    };
    window_ = intersection(
        window_, {pixel(std::floor(low.x()), k_.width), pixel(std::floor(low.y()), k_.height),
                  pixel(std::ceil(high.x()), k_.width) + 1, pixel(std::ceil(high.y()), k_.height) + 1});
  }

  Eigen::Array2d project(const Eigen::Vector3d& p) const {
    return {k_.fx * p.x() / p.z() + k_.cx, k_.fy * p.y() / p.z() + k_.cy};
  }
  Eigen::Vector3d ray(double u, double v) const { return {(u - k_.cx) / k_.fx, (v - k_.cy) / k_.fy, 1.0}; }

  /// Finds, for every pixel, the sides that run through its centre, give or take the rounding.
  void find_brushes() {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      std::array<Eigen::Vector3d, 4> polygon;  // what the near plane leaves of the triangle
      std::size_t n = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3d &p = corner(t, i), &q = corner(t, (i + 1) % 3);
        const bool p_visible = p.z() >= sight_near_plane, q_visible = q.z() >= sight_near_plane;
        if (p_visible) polygon[n++] = p;
        if (p_visible != q_visible)
          polygon[n++] = p + (q - p) * ((sight_near_plane - p.z()) / (q.z() - p.z()));
      }
      for (std::size_t i = 0; i < n; ++i) walk(t, polygon[i], polygon[(i + 1) % n]);
    }
    std::sort(brushes_.begin(), brushes_.end(), [](const Brush& a, const Brush& b) {
      return a.pixel != b.pixel ? a.pixel < b.pixel : a.triangle < b.triangle;
    });
  }

  /// How far from where exact arithmetic puts it the image of a point may be, pixels. \param error of the
  /// point itself, metres.
  double pixels_off(const Eigen::Vector3d& p, double error) const {
    const double slope = p.head<2>().cwiseAbs().maxCoeff() / p.z();
    return std::max(k_.fx, k_.fy) * error / p.z() * (1.0 + slope);
  }
  /// Of any of a triangle's vertices, metres.
  double error_of(std::uint32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    return std::max({errors_[a], errors_[b], errors_[c]});
  }

  /// Along the image of a side, by the axis along which it is longer.
  void walk(std::uint32_t triangle, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Array2d a = project(from), b = project(to), d = b - a;
    const double error = error_of(triangle), largest = a.abs().max(b.abs()).sum() + k_.width + k_.height;
    const double radius =
        std::min(4.0, std::max(pixels_off(from, error), pixels_off(to, error)) + image_rounding * largest);
    const int major = std::abs(d.x()) >= std::abs(d.y()) ? 0 : 1, minor = 1 - major;
    const std::array<int, 2> low{window_.u0, window_.v0}, high{window_.u1 - 1, window_.v1 - 1};
    const auto first = [&](double x, int axis) {
      return static_cast<int>(std::max(std::ceil(std::min(x, 1e6)), static_cast<double>(low[axis])));
    };
    const auto last = [&](double x, int axis) {
      return static_cast<int>(std::min(std::floor(std::max(x, -1e6)), static_cast<double>(high[axis])));
    };
    const double slope = d[major] != 0.0 ? d[minor] / d[major] : 0.0;
    const double reach = radius * std::hypot(1.0, slope);
    for (int i = first(std::min(a[major], b[major]) - radius, major);
         i <= last(std::max(a[major], b[major]) + radius, major); ++i) {
      const double at = a[minor] + (static_cast<double>(i) - a[major]) * slope;
      for (int j = first(at - reach, minor); j <= last(at + reach, minor); ++j) {
        const int u = major == 0 ? i : j, v = major == 0 ? j : i;
        brushes_.push_back({static_cast<std::uint32_t>(v * k_.width + u), triangle, radius});
      }
    }
  }

  const Eigen::Vector3d& corner(std::uint32_t triangle, std::size_t i) const {
    return vertices_[mesh_.triangles[triangle][i]];
  }

  /// The depths that the triangle's plane may have within `radius` pixels of a pixel's centre, and what its
  /// vertices are off, kept to the triangle's own.
  DepthRange depth_of(std::uint32_t triangle, int u, int v, double radius) const {
    const Eigen::Vector3d &a = corner(triangle, 0), &b = corner(triangle, 1), &c = corner(triangle, 2);
    const Eigen::Vector3d e1 = b - a, e2 = c - a, normal = e1.cross(e2);
    const double off = error_of(triangle);
    const double least =
        std::max(sight_near_plane, std::min({a.z(), b.z(), c.z()}) - off) * (1.0 - plane_rounding);
    const double most = (std::max({a.z(), b.z(), c.z()}) + off) * (1.0 + plane_rounding);
    // 1/z = normal . ray / offset is linear in the image. Edge-on planes and slender triangles are known less
    // well, as much as the products that cancel in `normal` and `offset` are larger than what is left of
    // them.
    const double offset = std::abs(normal.dot(a));
    const double inverse = std::abs(normal.dot(ray(u, v))) / offset;
    const double step = radius * std::hypot(normal.x() / k_.fx, normal.y() / k_.fy) / offset;
    const double products = plane_rounding * e1.norm() * e2.norm() * a.norm() + off * normal.norm();
    const double error = step + inverse * products / offset;
    if (!(error < inverse)) return {least, most};  // also where the plane runs through the camera
    return {std::clamp(1.0 / (inverse + error), least, most),
            std::clamp(1.0 / (inverse - error), least, most)};
  }

  /// A pixel whose centre lies well inside the triangle that it sees, or well outside of all.
  void look_inside(const RayMesh& rays, std::uint32_t pixel, int u, int v) {
    if (const auto triangle = rays.first_hit(Eigen::Vector3d::Zero(), ray(u, v), sight_near_plane))
      seen_.push_back({pixel, object_, depth_of(*triangle, u, v, 0.0), false});
  }

  /// A pixel with sides through its centre: what rays around it see, and what might be seen before that.
  void look_at_edges(const RayMesh& rays, std::uint32_t pixel, int u, int v, std::span<const Brush> brushes) {
    double radius = 0.0;
    for (const Brush& brush : brushes) radius = std::max(radius, brush.radius);
    bool may_miss = false;
    double farthest = 0.0;
    std::vector<DepthRange> depths;
    const auto cast = [&](double du, double dv) {
      const auto triangle = rays.first_hit(Eigen::Vector3d::Zero(), ray(u + du, v + dv), sight_near_plane);
      if (!triangle) {
        may_miss = true;
        return;
      }
      depths.push_back(depth_of(*triangle, u, v, radius));
      farthest = std::max(farthest, depths.back().far);
    };
    cast(0.0, 0.0);
    constexpr int directions = 12;
    for (const double part : {0.1, 0.4, 1.0})
      for (int i = 0; i < directions; ++i) {
        const double angle = 2.0 * std::numbers::pi * (i + part) / directions;
        cast(part * radius * std::cos(angle), part * radius * std::sin(angle));
      }
    if (may_miss) farthest = infinite_depth;
    for (const Brush& brush : brushes) {
      const DepthRange depth = depth_of(brush.triangle, u, v, radius);
      if (depth.near <= farthest) depths.push_back(depth);
    }
    put(pixel, depths, may_miss);
  }

  /// Ranges that overlap become one.
  void put(std::uint32_t pixel, std::vector<DepthRange>& depths, bool may_miss) {
    std::sort(depths.begin(), depths.end(),
              [](const DepthRange& a, const DepthRange& b) { return a.near < b.near; });
    const std::size_t first = seen_.size();
    for (const DepthRange& depth : depths) {
      if (seen_.size() > first && depth.near <= seen_.back().depth.far)
        seen_.back().depth.far = std::max(seen_.back().depth.far, depth.far);
      else
        seen_.push_back({pixel, object_, depth, may_miss});
    }
  }

  const Mesh& mesh_;
  const Intrinsics& k_;
  std::uint32_t object_;
  std::vector<Eigen::Vector3d> vertices_;  ///< camera frame
  std::vector<double> errors_;             ///< of the vertices, metres
  Window window_;
  std::vector<Brush> brushes_;
  std::vector<Sighting> seen_;
};

}  // namespace

std::vector<Sighting> sightings(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model,
                                const Intrinsics& intrinsics, std::uint32_t object) {
  return ObjectSight(mesh, camera_from_model, intrinsics, object).look();
}

}  // namespace perch
