#include "perch/model/rest_poses.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "perch/core/error.hpp"
#include "perch/model/convex_hull.hpp"
#include "perch/model/hull_faces.hpp"
#include "perch/model/shape_comparison.hpp"

namespace perch {
namespace {

constexpr double flatness = 1e-3;  // of the diameter
constexpr double thinnest = 1e-6;  // of the volume of a cube of that size: below it, it is flat
constexpr std::size_t most_compared =
    64;                                   // poses: a thing with more is a rock, on which none is like another
constexpr double declared_within = 0.05;  // radians: files hold rounded axes, scanned faces are not even

/// The face that the body tips over to, or nothing where it stays. It always goes down, so that it ends.
std::optional<std::size_t> next_face(const std::vector<HullFace>& faces, std::size_t face, double least_rise,
                                     double least_fall) {
  std::optional<std::size_t> next;
  double least = least_rise;
  for (const HullFace::Edge& edge : faces[face].edges)
    if (edge.rise < least && faces[edge.face].height < faces[face].height - least_fall) {
      least = edge.rise;
      next = edge.face;
    }
  return next;
}

/// The faces that hold, by falling share.
std::vector<StablePose> held_by_faces(const std::vector<HullFace>& faces, double least_rise,
                                      double least_fall) {
  std::vector<double> share(faces.size(), 0.0);
  double sum = 0.0;
  for (const HullFace& face : faces) sum += face.solid_angle;
  // From the lowest up, so that it is known where the next face, which is lower, leads.
  std::vector<std::size_t> by_height(faces.size()), end(faces.size());
  std::iota(by_height.begin(), by_height.end(), std::size_t{0});
  std::stable_sort(by_height.begin(), by_height.end(),
                   [&](std::size_t a, std::size_t b) { return faces[a].height < faces[b].height; });
  for (const std::size_t f : by_height) {
    const auto next = next_face(faces, f, least_rise, least_fall);
    end[f] = next ? end[*next] : f;
    share[end[f]] += faces[f].solid_angle / sum;
  }
  std::vector<StablePose> poses;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (share[f] > 0.0) poses.push_back({-faces[f].normal, share[f]});
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StablePose& a, const StablePose& b) { return a.share > b.share; });
  return poses;
}

/// The axis of the model's frame that a direction is, within `tolerance` (radians), or the direction.
Eigen::Vector3d snapped(const Eigen::Vector3d& up, double tolerance) {
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  const Eigen::Vector3d nearest = Eigen::Vector3d::Unit(axis) * (up[axis] > 0.0 ? 1.0 : -1.0);
  return (up - nearest).norm() <= tolerance ? nearest : up;
}

bool is_upright(const StablePose& pose) {
  return pose.up == Eigen::Vector3d::UnitZ();
}

}  // namespace

std::vector<StablePose> rest_poses(const Mesh& mesh, const ModelSymmetries& symmetries,
                                   const RestPoseSettings& settings) {
  const Mesh hull = convex_hull(mesh);
  const double across = hull_diameter(hull);
  const VolumeCentroid of_hull = volume_centroid(hull);
  if (!(of_hull.volume > thinnest * across * across * across)) throw InputError("is flat or nearly so");
  Eigen::Vector3d centre = of_hull.centroid;
  if (is_closed(mesh)) {
    const VolumeCentroid of_mesh = volume_centroid(mesh);
    if (std::abs(of_mesh.volume) > thinnest * of_hull.volume) centre = of_mesh.centroid;
  }
  std::vector<HullFace> faces = hull_faces(hull, centre, flatness * across);
  // Triangles that face inwards and outwards may put the centroid of their solid anywhere.
  const auto is_inside = [](const HullFace& face) { return face.height > 0.0; };
  if (!std::all_of(faces.begin(), faces.end(), is_inside)) {
    centre = of_hull.centroid;
    faces = hull_faces(hull, centre, flatness * across);
  }

  double radius = 0.0;
  for (const Eigen::Vector3f& p : hull.vertices)
    radius = std::max(radius, (p.cast<double>() - centre).norm());
  const std::vector<StablePose> held = held_by_faces(faces, settings.least_rise * across, 1e-9 * across);
  const ShapeComparison shape(mesh, centre, settings.tolerance);
  std::vector<StablePose> poses;
  for (const StablePose& pose : held) {
    StablePose found = pose;
    found.up = snapped(pose.up, 0.5 * settings.tolerance / radius);
    const auto same = [&](const StablePose& other) {
      return (other.up - found.up).norm() * radius <= settings.tolerance ||
             symmetries.equal_ups(other.up, found.up, declared_within) ||
             (poses.size() < most_compared && shape.equal_ups(other.up, found.up));
    };
    const auto known = std::find_if(poses.begin(), poses.end(), same);
    if (known == poses.end()) {
      poses.push_back(found);
      continue;
    }
    known->share += found.share;
    if (is_upright(found)) known->up = found.up;
  }

  std::stable_sort(poses.begin(), poses.end(), [](const StablePose& a, const StablePose& b) {
    if (is_upright(a) != is_upright(b)) return is_upright(a);
    return a.share > b.share;
  });
  std::vector<StablePose> likely;
  for (const StablePose& pose : poses)
    if (likely.size() < settings.most &&
        (is_upright(pose) || pose.share >= settings.least_share || poses.size() == 1))
      likely.push_back(pose);
  // A thing of very many faces that all look different: the likeliest is better than none.
  if (likely.empty()) likely.push_back(poses.front());
  return likely;
}

}  // namespace perch
