#include "perch/model/hull_faces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace perch {
namespace {

/// The corners of a triangle about the centre.
using Corners = std::array<Eigen::Vector3d, 3>;

Corners corners_of(const Mesh& hull, std::size_t triangle, const Eigen::Vector3d& centre) {
  const auto& [i, j, k] = hull.triangles[triangle];
  return {hull.vertices[i].cast<double>() - centre, hull.vertices[j].cast<double>() - centre,
          hull.vertices[k].cast<double>() - centre};
}

Eigen::Vector3d area_normal(const Corners& c) {
  return (c[1] - c[0]).cross(c[2] - c[0]);
}

/// Of a triangle seen from the origin (Van Oosterom and Strackee, "The solid angle of a plane triangle",
/// 1983).
double solid_angle(const Corners& c) {
  const double a = c[0].norm(), b = c[1].norm(), d = c[2].norm();
  return 2.0 * std::atan2(c[0].dot(c[1].cross(c[2])),
                          a * b * d + c[0].dot(c[1]) * d + c[1].dot(c[2]) * a + c[2].dot(c[0]) * b);
}

/// Each triangle's neighbours: [i] beyond the edge from corner i to the next.
std::vector<std::array<std::size_t, 3>> neighbours(const Mesh& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> triangle_of;
  for (std::size_t t = 0; t < hull.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i)
      triangle_of[{hull.triangles[t][i], hull.triangles[t][(i + 1) % 3]}] = t;
  std::vector<std::array<std::size_t, 3>> out(hull.triangles.size());
  for (std::size_t t = 0; t < hull.triangles.size(); ++t)
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = triangle_of.find({hull.triangles[t][(i + 1) % 3], hull.triangles[t][i]});
      out[t][i] = found == triangle_of.end() ? t : found->second;
    }
  return out;
}

}  // namespace

std::vector<HullFace> hull_faces(const Mesh& hull, const Eigen::Vector3d& centre, double flatness) {
  const std::size_t n = hull.triangles.size();
  std::vector<Corners> corners;
  std::vector<double> areas;
  for (std::size_t t = 0; t < n; ++t) {
    corners.push_back(corners_of(hull, t, centre));
    areas.push_back(area_normal(corners[t]).norm());
  }
  const auto beside = neighbours(hull);

  // Each face is the plane of its largest triangle, whose normal is the surest.
  std::vector<std::size_t> by_area(n), face_of(n, n);
  std::iota(by_area.begin(), by_area.end(), std::size_t{0});
  std::stable_sort(by_area.begin(), by_area.end(),
                   [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });
  std::vector<HullFace> faces;
  std::vector<std::vector<std::size_t>> members;
  for (const std::size_t seed : by_area) {
    if (face_of[seed] != n || areas[seed] <= 0.0) continue;
    HullFace face;
    face.normal = area_normal(corners[seed]).normalized();
    face.height = face.normal.dot(corners[seed][0]);
    const auto in_plane = [&](std::size_t t) {
      return std::all_of(corners[t].begin(), corners[t].end(), [&](const Eigen::Vector3d& p) {
        return std::abs(face.normal.dot(p) - face.height) <= flatness;
      });
    };
    std::vector<std::size_t> reached{seed};
    face_of[seed] = faces.size();
    for (std::size_t i = 0; i < reached.size(); ++i)
      for (const std::size_t t : beside[reached[i]])
        if (face_of[t] == n && in_plane(t)) {
          face_of[t] = faces.size();
          reached.push_back(t);
        }
    for (const std::size_t t : reached) face.solid_angle += solid_angle(corners[t]);
    faces.push_back(std::move(face));
    members.push_back(std::move(reached));
  }

  for (std::size_t f = 0; f < faces.size(); ++f)
    for (const std::size_t t : members[f])
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t other = face_of[beside[t][i]];
        if (other == f || other == n) continue;
        const Eigen::Vector3d from = corners[t][i], along = corners[t][(i + 1) % 3] - from;
        const Eigen::Vector3d outwards = along.cross(faces[f].normal);
        if (outwards.norm() <= 0.0) continue;
        // The centre of mass goes around the edge, which lies this far from below it.
        const double beside_foot = from.dot(outwards.normalized());
        const double rise = std::hypot(faces[f].height, beside_foot) - faces[f].height;
        faces[f].edges.push_back({other, std::copysign(rise, beside_foot)});
      }
  return faces;
}

}  // namespace perch
