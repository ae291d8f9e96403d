#include "perch/observation/support_plane.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "perch/core/random.hpp"

namespace perch {
namespace {

constexpr int samples_wanted = 6000, trials = 400, planes_looked_for = 6, refits = 8;
constexpr double least_share = 0.02;  // of the readings; what is smaller is no plane to stand on
constexpr double least_up = 0.15;     // of a normal's part along the image's up
constexpr double least_facing = 0.8;  // towards the camera, of one seen from far above, which may be rolled
constexpr double standing_height = 0.012;  // metres above a plane from which something stands on it
constexpr double tallest = 0.6;            // metres; higher things are walls and other tables
constexpr double cell = 0.02;              // metres, of the map of what a plane shows
constexpr double same_direction = 0.966,
                 same_height = 0.03;        // cosine of 15 degrees; metres: one uneven surface
constexpr double table_above_floor = 0.25;  // metres; what is nearer may be the top of a box on the table
constexpr double table_over_floor = 0.05,
                 top_over_table = 0.5;  // readings of the higher plane over those below
constexpr int least_standing = 40;      // cells on which something stands

/// A thinned depth image.
std::vector<Eigen::Vector3d> thinned(const DepthImage& depth, const Intrinsics& intrinsics) {
  const RaySlopes rays(intrinsics);
  const double pixels = static_cast<double>(depth.size());
  const int step = std::max(1, static_cast<int>(std::sqrt(pixels / samples_wanted)));
  std::vector<Eigen::Vector3d> points;
  for (int v = step / 2; v < depth.height(); v += step)
    for (int u = step / 2; u < depth.width(); u += step)
      if (depth(u, v) > 0.0F) points.push_back(rays.point(u, v, depth(u, v)).cast<double>());
  return points;
}

class PlaneFinder {
 public:
  PlaneFinder(const DepthImage& depth, const Intrinsics& intrinsics, const PlaneSearch& search)
      : depth_(depth),
        intrinsics_(intrinsics),
        rays_(intrinsics),
        search_(search),
        random_(search.seed),
        points_(thinned(depth, intrinsics)),
        claimed_(depth.width(), depth.height(), 0) {}

  std::optional<SupportPlane> run() {
    for (const float z : depth_.data()) readings_ += z > 0.0F;
    std::vector<SupportPlane> found;
    std::vector<Eigen::Vector3d> left = points_;
    for (int i = 0; i < planes_looked_for; ++i) {
      auto plane = dominant(left);
      if (!plane) break;
      const Eigen::Vector3d middle = refit(*plane);
      claim(*plane);
      std::erase_if(left, [&](const Eigen::Vector3d& p) {
        return std::abs(plane->above(p)) <= 1.5 * plane_tolerance(p.z());
      });
      const bool apart = std::all_of(found.begin(), found.end(), [&](const SupportPlane& other) {
        return other.normal.dot(plane->normal) < same_direction ||
               std::abs(other.above(middle)) >= same_height;
      });
      if (allowed(plane->normal) && plane->share >= least_share && apart) found.push_back(*plane);
    }
    std::erase_if(found, [&](const SupportPlane& plane) { return plane.area < search_.least_area; });
    // A wall faces the camera too: only where nothing points up in the image may up be elsewhere.
    if (!search_.up &&
        std::any_of(found.begin(), found.end(), [](const auto& p) { return points_up(p.normal); }))
      std::erase_if(found, [](const SupportPlane& plane) { return !points_up(plane.normal); });
    if (found.empty()) return std::nullopt;
    // From the one with most readings up to higher ones: the table above the floor, but not the top of a box
    // on the table.
    std::sort(found.begin(), found.end(),
              [](const SupportPlane& a, const SupportPlane& b) { return a.readings > b.readings; });
    const SupportPlane* best = &found.front();
    for (const SupportPlane& plane : found) {
      const double higher = best->distance - plane.distance;
      const double ratio = static_cast<double>(plane.readings) / static_cast<double>(best->readings);
      const bool large = ratio >= (higher >= table_above_floor ? table_over_floor : top_over_table);
      // Floor, table and shelf are parallel, as far as the sensor keeps them so; a plane laid across a wall
      // and what stands before it is not.
      const bool parallel = plane.normal.dot(best->normal) >= same_direction;
      if (higher > 0.0 && parallel && large && carries_something(plane)) best = &plane;
    }
    return *best;
  }

 private:
  bool allowed(const Eigen::Vector3d& normal) const {
    if (search_.up) return normal.dot(*search_.up) >= std::cos(search_.most_tilt);
    return points_up(normal) || -normal.z() >= least_facing;
  }

  static bool points_up(const Eigen::Vector3d& normal) { return -normal.y() >= least_up; }

  /// The plane through three samples that most others lie on.
  std::optional<SupportPlane> dominant(const std::vector<Eigen::Vector3d>& points) {
    if (points.size() < 50) return std::nullopt;
    SupportPlane best;
    std::int64_t most = 0;
    for (int trial = 0; trial < trials; ++trial) {
      const auto drawn = [&] { return points[random_.below(points.size())]; };
      const Eigen::Vector3d a = drawn(), b = drawn(), c = drawn();
      Eigen::Vector3d normal = (b - a).cross(c - a);
      if (normal.norm() < 1e-6) continue;
      normal.normalize();
      if (normal.dot(a) > 0.0) normal = -normal;
      if (!allowed(normal)) continue;
      SupportPlane plane{normal, -normal.dot(a), 0, 0, 0, 0};
      std::int64_t count = 0;
      for (const Eigen::Vector3d& p : points) count += std::abs(plane.above(p)) <= plane_tolerance(p.z());
      if (count <= most) continue;
      most = count;
      best = plane;
    }
    if (static_cast<double>(most) < least_share * static_cast<double>(points_.size())) return std::nullopt;
    return best;
  }

  /// Least squares with Tukey's weights over all readings that no other plane has claimed; the weights' width
  /// shrinks to the tolerance. Returns the middle of what lies on it.
  Eigen::Vector3d refit(SupportPlane& plane) const {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (int round = 0; round < refits; ++round) {
      const double width = round < refits / 2 ? 2.0 : 1.2;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
      double weights = 0.0;
      for_each_reading([&](int, int, const Eigen::Vector3d& p) {
        // In units of the tolerance, so that far readings weigh as their noise allows.
        const double tolerance = plane_tolerance(p.z()), off = plane.above(p) / (width * tolerance);
        if (std::abs(off) >= 1.0) return;
        const double weight = std::pow(1.0 - off * off, 2) / (tolerance * tolerance);
        sum += weight * p;
        squares += weight * p * p.transpose();
        weights += weight;
      });
      if (weights <= 0.0) return middle;
      const Eigen::Vector3d mean = sum / weights;
      middle = mean;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares / weights - mean * mean.transpose());
      Eigen::Vector3d normal = axes.eigenvectors().col(0);
      if (normal.dot(mean) > 0.0) normal = -normal;
      plane.normal = normal;
      plane.distance = -normal.dot(mean);
    }
    double squared = 0.0;
    plane.readings = 0;
    Image<std::uint8_t> on_it(depth_.width(), depth_.height(), 0);
    for_each_reading([&](int u, int v, const Eigen::Vector3d& p) {
      const double off = plane.above(p);
      if (std::abs(off) > plane_tolerance(p.z())) return;
      ++plane.readings;
      squared += off * off;
      on_it(u, v) = 1;
    });
    if (plane.readings > 0) plane.rms = std::sqrt(squared / static_cast<double>(plane.readings));
    plane.share =
        static_cast<double>(plane.readings) / static_cast<double>(std::max<std::int64_t>(1, readings_));
    plane.area = largest_part(plane, on_it);
    return middle;
  }

  /// What the largest connected part of a plane's pixels shows of it, square metres. Planes that cut across
  /// several objects are made of many small parts.
  double largest_part(const SupportPlane& plane, Image<std::uint8_t>& left) const {
    double largest = 0.0;
    std::vector<std::pair<int, int>> part;
    for (int v0 = 0; v0 < left.height(); ++v0)
      for (int u0 = 0; u0 < left.width(); ++u0) {
        if (!left(u0, v0)) continue;
        part.assign(1, {u0, v0});
        left(u0, v0) = 0;
        double area = 0.0;
        while (!part.empty()) {
          const auto [u, v] = part.back();
          part.pop_back();
          const Eigen::Vector3d p = rays_.point(u, v, depth_(u, v)).cast<double>();
          // What a pixel shows of a plane: z^2 / (fx fy) over the cosine, for a ray of length 1 along z.
          area +=
              std::pow(p.z(), 3) / (intrinsics_.fx * intrinsics_.fy * std::max(1e-3, -plane.normal.dot(p)));
          for (const auto& [du, dv] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}})
            if (left.contains(u + du, v + dv) && left(u + du, v + dv)) {
              left(u + du, v + dv) = 0;
              part.emplace_back(u + du, v + dv);
            }
        }
        largest = std::max(largest, area);
      }
    return largest;
  }

  /// Its readings are no other plane's.
  void claim(const SupportPlane& plane) {
    for_each_reading([&](int u, int v, const Eigen::Vector3d& p) {
      claimed_(u, v) = std::abs(plane.above(p)) <= 1.5 * plane_tolerance(p.z());
    });
  }

  /// Whether things stand on it, seen on or beside parts of it that are seen.
  bool carries_something(const SupportPlane& plane) const {
    const Eigen::Vector3d across = plane.normal.unitOrthogonal(), along = plane.normal.cross(across);
    std::map<std::pair<int, int>, int> shown, standing;
    const auto cell_of = [&](const Eigen::Vector3d& p, double size) {
      return std::pair(static_cast<int>(std::floor(across.dot(p) / size)),
                       static_cast<int>(std::floor(along.dot(p) / size)));
    };
    constexpr double around = 5.0 * cell;
    for (const Eigen::Vector3d& p : points_) {
      const double above = plane.above(p);
      if (std::abs(above) <= plane_tolerance(p.z()))
        ++shown[cell_of(p, around)];
      else if (above > standing_height && above > plane_tolerance(p.z()) && above < tallest)
        ++standing[cell_of(p, around)];
    }
    int on_it = 0;
    for (const auto& [place, count] : standing) {
      bool beside = false;
      for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j) beside = beside || shown.contains({place.first + i, place.second + j});
      if (beside) on_it += count;
    }
    return on_it >= least_standing;
  }

  template <typename Visit>
  void for_each_reading(const Visit& visit) const {
    for (int v = 0; v < depth_.height(); ++v)
      for (int u = 0; u < depth_.width(); ++u)
        if (depth_(u, v) > 0.0F && !claimed_(u, v))
          visit(u, v, rays_.point(u, v, depth_(u, v)).cast<double>());
  }

  const DepthImage& depth_;
  const Intrinsics& intrinsics_;
  const RaySlopes rays_;
  const PlaneSearch& search_;
  Random random_;
  std::vector<Eigen::Vector3d> points_;
  Image<std::uint8_t> claimed_;  ///< readings of planes found before
  std::int64_t readings_ = 0;
};

}  // namespace

double plane_tolerance(double depth) {
  return 0.004 + 0.004 * depth * depth;
}

std::optional<SupportPlane> find_support_plane(const DepthImage& depth, const Intrinsics& intrinsics,
                                               const PlaneSearch& search) {
  return PlaneFinder(depth, intrinsics, search).run();
}

}  // namespace perch
