#include "perch/model/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>

namespace perch {
namespace {

constexpr std::size_t most_pieces = 300'000;
constexpr std::size_t pieces_asked = 4;

using Triangle = std::array<Eigen::Vector3f, 3>;

/// Distance from p to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double distance_to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  const bool above = area > 0.0 && (b - a).cross(p - a).dot(normal) >= 0.0 &&
                     (c - b).cross(p - b).dot(normal) >= 0.0 && (a - c).cross(p - c).dot(normal) >= 0.0;
  if (above) return std::abs(normal.dot(p - a)) / std::sqrt(area);
  const auto to_edge = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d edge = to - from;
    const double length = edge.squaredNorm();
    const double t = length > 0.0 ? std::clamp(edge.dot(p - from) / length, 0.0, 1.0) : 0.0;
    return (from + t * edge - p).norm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

/// Calls visit(middle) for the pieces of a triangle, which is halved across its longest edge until none is
/// longer than the spacing. Stops early where visit returns false.
template <typename Visit>
bool for_each_piece(const Triangle& triangle, float spacing, const Visit& visit) {
  std::vector<Triangle> open{triangle};
  while (!open.empty()) {
    const Triangle t = open.back();
    open.pop_back();
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if ((t[(k + 1) % 3] - t[k]).squaredNorm() > (t[(longest + 1) % 3] - t[longest]).squaredNorm())
        longest = k;
    const Eigen::Vector3f &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
    if ((b - a).norm() <= spacing) {
      if (!visit(Eigen::Vector3f((a + b + c) / 3.0F))) return false;
      continue;
    }
    const Eigen::Vector3f middle = 0.5F * (a + b);
    open.push_back({a, middle, c});
    open.push_back({middle, b, c});
  }
  return true;
}

}  // namespace

struct SurfaceDistance::Tree {
  struct Middles {
    const std::vector<Eigen::Vector3f>& points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };

  explicit Tree(const std::vector<Eigen::Vector3f>& points) : middles{points}, index(3, middles, {12}) {}

  Middles middles;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Middles>, Middles, 3> index;
};

SurfaceDistance::SurfaceDistance(const Mesh& mesh, double spacing) : mesh_(mesh) {
  const std::size_t most = std::max(most_pieces, 2 * mesh.triangles.size());
  const auto cut = [&](float length) {
    middles_.clear();
    triangle_of_.clear();
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const auto add = [&](const Eigen::Vector3f& middle) {
        middles_.push_back(middle);
        triangle_of_.push_back(t);
        return middles_.size() < most;
      };
      if (!for_each_piece({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}, length, add)) return false;
    }
    return true;
  };
  for (auto length = static_cast<float>(spacing); !cut(length); length *= 1.5F) {
  }
  tree_ = std::make_unique<Tree>(middles_);
}

SurfaceDistance::~SurfaceDistance() = default;

double SurfaceDistance::operator()(const Eigen::Vector3d& p, double enough) const {
  const Eigen::Vector3f at = p.cast<float>();
  std::array<std::uint32_t, pieces_asked> pieces{};
  std::array<float, pieces_asked> squared{};
  double least = std::numeric_limits<double>::infinity();
  // Mostly the nearest piece is enough.
  for (const std::size_t asked : {std::size_t{1}, pieces_asked}) {
    if (least <= enough) break;
    const std::size_t found = tree_->index.knnSearch(at.data(), asked, pieces.data(), squared.data());
    for (std::size_t i = 0; i < found && least > enough; ++i) {
      const auto& [a, b, c] = mesh_.triangles[triangle_of_[pieces[i]]];
      least = std::min(
          least, distance_to_triangle(p, mesh_.vertices[a].cast<double>(), mesh_.vertices[b].cast<double>(),
                                      mesh_.vertices[c].cast<double>()));
    }
  }
  return least;
}

}  // namespace perch
