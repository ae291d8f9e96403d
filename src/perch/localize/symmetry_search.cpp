#include "perch/localize/symmetry_search.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <unordered_set>
#include <utility>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/model/surface_distance.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

using std::numbers::pi;

constexpr int finest = 36;
constexpr double usual_share_of_delta = 0.5;
constexpr double share_beyond = 0.005;
constexpr int azimuths = 16;
constexpr double elevations_deg[] = {5.0, 25.0, 45.0, 65.0, 85.0};
constexpr int continuous_turns = 24;
constexpr std::size_t most_points = 8000;

/// Points of the surface that cameras around and above the mesh see: about one a cube of the spacing, or
/// evenly drawn ones of these where they are many.
class SeenSurface {
 public:
  SeenSurface(const Mesh& mesh, double delta) : mesh_(mesh) {
    const Eigen::AlignedBox3d box = mesh.bounds().cast<double>();
    middle_ = box.center();
    reach_ = std::max(0.5 * box.diagonal().norm(), 1e-6);
    spacing_ = std::clamp(usual_share_of_delta * delta, reach_ / 100.0, reach_ / 40.0);
    image_size_ = 4 + static_cast<int>(std::ceil(4.0 * reach_ / spacing_));  // two pixels a cube
    int turn = 0;
    for (const double elevation : elevations_deg) {
      // Each ring is turned by another part of its step.
      const double offset = static_cast<double>(turn++) / static_cast<double>(std::size(elevations_deg));
      for (int i = 0; i < azimuths; ++i) look((i + offset) * 2.0 * pi / azimuths, elevation * pi / 180.0);
    }
    // In an order that has nothing to do with where they lie, so that a few of them stand for all.
    Random random(1);
    for (std::size_t i = points_.size(); i > 1; --i) std::swap(points_[i - 1], points_[random.below(i)]);
    points_.resize(std::min(points_.size(), most_points));
  }
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  double spacing() const { return spacing_; }

 private:
  void look(double azimuth, double elevation) {
    const Eigen::Vector3d outwards(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    const double distance = std::max(6.0 * reach_, reach_ + 2.0 * double{Rasterizer::near_plane});
    Eigen::Isometry3d mesh_from_camera = Eigen::Isometry3d::Identity();
    mesh_from_camera.linear().col(0) = Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0.0);
    mesh_from_camera.linear().col(2) = -outwards;
    mesh_from_camera.linear().col(1) =
        mesh_from_camera.linear().col(2).cross(mesh_from_camera.linear().col(0));
    mesh_from_camera.translation() = middle_ + distance * outwards;
    const double half = 0.5 * image_size_;
    const double focal = (half - 2.0) * std::sqrt(distance * distance - reach_ * reach_) / reach_;
    const Intrinsics intrinsics{image_size_, image_size_, focal, focal, half - 0.5, half - 0.5};
    const DepthPatch patch = Rasterizer(intrinsics).render(mesh_, mesh_from_camera.inverse());
    const RaySlopes rays(intrinsics);
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u) {
        const float z = patch.at(u, v);
        if (z < no_surface) keep(mesh_from_camera * rays.point(u, v, z).cast<double>());
      }
  }

  void keep(const Eigen::Vector3d& p) {
    const Eigen::Vector3d cube = ((p - middle_) / spacing_).array().floor() + 4096.0;
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) key = key << 16 | static_cast<std::uint64_t>(cube[axis]);
    if (taken_.insert(key).second) points_.push_back(p);
  }

  const Mesh& mesh_;
  Eigen::Vector3d middle_;
  double reach_ = 0.0, spacing_ = 0.0;
  int image_size_ = 0;
  std::unordered_set<std::uint64_t> taken_;
  std::vector<Eigen::Vector3d> points_;
};

/// Tells which turns leave what is seen of a mesh where it was.
class TurnJudge {
 public:
  TurnJudge(const Mesh& mesh, double delta)
      : delta_(delta), seen_(mesh, delta), distance_(mesh, usual_share_of_delta * delta) {}

  /// The finest symmetry about an upright axis.
  Symmetry symmetry_about(const Eigen::Vector2d& axis) const {
    // Turns by the golden angle come close to half of every period, where the turned shape differs most.
    const double golden = pi * (3.0 - std::sqrt(5.0));
    int turns = 0;
    while (turns < continuous_turns && holds(axis, golden * (turns + 0.5))) ++turns;
    if (turns == continuous_turns) return Symmetry::continuous();

    // What each turn of p / q of a circle was found to be: many n share it.
    std::map<std::pair<int, int>, bool> known;
    const auto turn_holds = [&](int p, int q) {
      const auto [at, is_new] = known.try_emplace({p, q}, false);
      if (is_new) at->second = holds(axis, 2.0 * pi * p / q);
      return at->second;
    };
    // The n-fold turns, those first that most other n share.
    const auto all_hold = [&](int n) {
      for (int q = 2; q <= n; ++q)
        for (int p = 1; n % q == 0 && p < q; ++p)
          if (std::gcd(p, q) == 1 && !turn_holds(p, q)) return false;
      return true;
    };
    for (int n = finest; n > 1; --n)
      if (all_hold(n)) return Symmetry::n_fold(n);
    return Symmetry::none();
  }

  Eigen::Vector2d middle() const {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector3d& p : seen_.points()) sum += p.head<2>();
    return sum / static_cast<double>(std::max<std::size_t>(1, seen_.points().size()));
  }

 private:
  bool holds(const Eigen::Vector2d& axis, double angle) const {
    const double usual = usual_share_of_delta * delta_;
    const auto most_beyond =
        static_cast<std::size_t>(share_beyond * static_cast<double>(seen_.points().size()));
    const Eigen::Rotation2Dd turn(angle);
    std::size_t beyond = 0;
    for (const Eigen::Vector3d& p : seen_.points()) {
      const Eigen::Vector2d turned = axis + turn * (p.head<2>() - axis);
      const double distance = distance_({turned.x(), turned.y(), p.z()}, usual);
      if (distance > delta_) return false;
      if (distance > usual && ++beyond > most_beyond) return false;
    }
    return true;
  }

  double delta_;
  SeenSurface seen_;
  SurfaceDistance distance_;
};

/// Continuous is finer than any number of folds.
bool is_finer(const Symmetry& a, const Symmetry& b) {
  if (b.is_continuous()) return false;
  return a.is_continuous() || a.fold() > b.fold();
}

}  // namespace

FoundSymmetry find_symmetry(const Mesh& mesh, double delta) {
  const TurnJudge judge(mesh, delta);
  FoundSymmetry found;
  found.symmetry = judge.symmetry_about(Eigen::Vector2d::Zero());
  if (found.symmetry.is_continuous()) return found;
  const Eigen::Vector2d middle = judge.middle();
  const Symmetry there = judge.symmetry_about(middle);
  if (is_finer(there, found.symmetry)) found.better_axis = {middle, there};
  return found;
}

}  // namespace perch
