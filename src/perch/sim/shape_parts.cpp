#include "perch/sim/shape_parts.hpp"

#include <numbers>
#include <vector>

namespace perch {

Eigen::Isometry3d shift(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

Profile vessel(double bottom_radius, double rim_radius, double height, double wall, double bottom) {
  const double lean = (rim_radius - bottom_radius) / height;
  return {{0.0, 0.0},
          {bottom_radius, 0.0},
          {rim_radius, height},
          {rim_radius - wall, height},
          {bottom_radius + lean * bottom - wall, bottom},
          {0.0, bottom}};
}

Mesh handle_mesh(const HandleShape& handle, double wall_radius_top, double wall_radius_bottom) {
  constexpr int chords = 24;
  const double out = handle.reach * 4.0 / 3.0;  // the curve reaches three quarters of its control points
  const Eigen::Vector2d p0(wall_radius_top, handle.top), p1(wall_radius_top + out, handle.top),
      p2(wall_radius_bottom + out, handle.bottom), p3(wall_radius_bottom, handle.bottom);
  std::vector<Eigen::Vector2d> path;
  for (int i = 0; i <= chords; ++i) {
    const double t = static_cast<double>(i) / chords, s = 1.0 - t;
    path.emplace_back(s * s * s * p0 + 3 * s * s * t * p1 + 3 * s * t * t * p2 + t * t * t * p3);
  }
  return tube(path, handle.half_width, handle.half_thickness, 16);
}

Mesh turned(std::span<const ProfilePoint> profile, const Section& section, double spacing) {
  return revolve(subdivided(profile, spacing), turned_sides, section);
}

Mesh frustum(double bottom_radius, double top_radius, double height) {
  return turned(Profile{{0.0, 0.0}, {bottom_radius, 0.0}, {top_radius, height}, {0.0, height}});
}

Mesh upside_down(Mesh mesh) {
  // Written out: half a turn has no rounding.
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex = {vertex.x(), -vertex.y(), -vertex.z()};
  return stood_on_ground(std::move(mesh));
}

Mesh on_its_side(Mesh mesh) {
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex = {vertex.z(), vertex.y(), -vertex.x()};
  const Eigen::Vector3f middle = mesh.bounds().center();
  for (Eigen::Vector3f& vertex : mesh.vertices) vertex.head<2>() -= middle.head<2>();
  return stood_on_ground(std::move(mesh));
}

}  // namespace perch
