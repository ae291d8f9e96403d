#include "perch/model/shape_comparison.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>
#include <span>

#include "perch/core/random.hpp"

namespace perch {
namespace {

constexpr std::size_t probe_count = 400;
constexpr double share_within = 0.95, farthest_of_tolerance = 3.0;

double area(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& [i, j, k] : mesh.triangles)
    sum += 0.5 * (mesh.vertices[j] - mesh.vertices[i])
                     .cast<double>()
                     .cross((mesh.vertices[k] - mesh.vertices[i]).cast<double>())
                     .norm();
  return sum;
}

/// Points drawn evenly from the surface, about `centre`.
std::vector<Eigen::Vector3d> drawn_from(const Mesh& mesh, const Eigen::Vector3d& centre) {
  std::vector<double> sums;
  double sum = 0.0;
  for (const auto& [i, j, k] : mesh.triangles) {
    sum += (mesh.vertices[j] - mesh.vertices[i])
               .cast<double>()
               .cross((mesh.vertices[k] - mesh.vertices[i]).cast<double>())
               .norm();
    sums.push_back(sum);
  }
  Random random(1);  // the same points each time
  std::vector<Eigen::Vector3d> points;
  while (points.size() < probe_count) {
    const auto found = std::lower_bound(sums.begin(), sums.end(), sum * random.uniform());
    const auto& [i, j, k] =
        mesh.triangles[static_cast<std::size_t>(std::min(found, sums.end() - 1) - sums.begin())];
    const double s = std::sqrt(random.uniform()), t = random.uniform();
    points.push_back((1.0 - s) * mesh.vertices[i].cast<double>() +
                     s * (1.0 - t) * mesh.vertices[j].cast<double>() +
                     s * t * mesh.vertices[k].cast<double>() - centre);
  }
  return points;
}

/// Points such that every point of the surface has one within two thirds of `spacing`: the centroids of its
/// triangles, halved across their longest sides until none is longer. Also of needles, which thin solids of
/// revolution are made of, there are no more than their length asks for.
std::vector<Eigen::Vector3f> spread_over(const Mesh& mesh, double spacing) {
  using Corners = std::array<Eigen::Vector3f, 3>;
  const auto longest = static_cast<float>(spacing * spacing);
  std::vector<Eigen::Vector3f> points;
  std::vector<Corners> open;
  for (const auto& [i, j, k] : mesh.triangles) {
    open.push_back({mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]});
    while (!open.empty()) {
      const Corners c = open.back();
      open.pop_back();
      std::size_t side = 0;
      float squared = -1.0F;
      for (std::size_t s = 0; s < 3; ++s)
        if (const float length = (c[(s + 1) % 3] - c[s]).squaredNorm(); length > squared) {
          squared = length;
          side = s;
        }
      if (squared <= longest) {
        points.push_back((c[0] + c[1] + c[2]) / 3.0F);
        continue;
      }
      const Eigen::Vector3f middle = 0.5F * (c[side] + c[(side + 1) % 3]);
      open.push_back({c[side], middle, c[(side + 2) % 3]});
      open.push_back({middle, c[(side + 1) % 3], c[(side + 2) % 3]});
    }
  }
  return points;
}

/// The second moments of the surface about its centroid, over its area.
Eigen::Matrix3d surface_covariance(const Mesh& mesh) {
  double sum = 0.0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[i].cast<double>(), b = mesh.vertices[j].cast<double>(),
                          c = mesh.vertices[k].cast<double>(), corners = a + b + c;
    const double weight = 0.5 * (b - a).cross(c - a).norm();
    sum += weight;
    first += weight / 3.0 * corners;
    second += weight / 12.0 *
              (a * a.transpose() + b * b.transpose() + c * c.transpose() + corners * corners.transpose());
  }
  first /= sum;
  return second / sum - first * first.transpose();
}

}  // namespace

struct ShapeComparison::Tree {
  struct Points {
    std::vector<Eigen::Vector3f> all;
    std::size_t kdtree_get_point_count() const { return all.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return all[i][static_cast<int>(axis)]; }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3>;

  Tree(Points given, double error_of_points)
      : points(std::move(given)),
        index(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16)),
        error(error_of_points) {
    index.buildIndex();
  }
  double distance(const Eigen::Vector3d& from) const {
    const Eigen::Vector3f query = from.cast<float>();
    nanoflann::KNNResultSet<float> nearest(1);
    std::size_t at = 0;
    float squared = 0.0F;
    nearest.init(&at, &squared);
    index.findNeighbors(nearest, query.data(), nanoflann::SearchParams());
    return std::sqrt(double{squared});
  }

  Points points;
  Index index;
  double error;  ///< the surface may be this much nearer than the nearest of the points
};

ShapeComparison::ShapeComparison(const Mesh& mesh, const Eigen::Vector3d& centre, double tolerance)
    : probes_(drawn_from(mesh, centre)), tolerance_(tolerance) {
  // Spacing half the tolerance, unless that makes more points than are worth it. The last of the three also
  // holds where rounding would keep a side from getting shorter.
  constexpr double most_points = 30000.0, of_size = 0.003;
  const double size = mesh.bounds().sizes().cast<double>().norm();
  const double spacing = std::max({0.5 * tolerance, std::sqrt(area(mesh) / most_points), of_size * size});
  Tree::Points points{spread_over(mesh, spacing)};
  for (Eigen::Vector3f& p : points.all) p -= centre.cast<float>();
  tree_ = std::make_unique<Tree>(std::move(points), 2.0 / 3.0 * spacing);
  for (const Eigen::Vector3f& p : mesh.vertices) corners_.push_back(p.cast<double>() - centre);
  axis_ = axis_of_revolution(mesh);
  for (const Eigen::Vector3d& p : corners_) radius_ = std::max(radius_, p.norm());
}

ShapeComparison::~ShapeComparison() = default;

std::optional<Eigen::Vector3d> ShapeComparison::axis_of_revolution(const Mesh& mesh) const {
  constexpr double alike = 0.03, unlike = 0.06;  // moments, of the largest
  constexpr int turns = 5;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> moments(surface_covariance(mesh));
  const Eigen::Vector3d m = moments.eigenvalues() / moments.eigenvalues().maxCoeff();  // ascending
  std::optional<Eigen::Vector3d> axis;
  if (m[1] - m[0] < alike && m[2] - m[1] > unlike) axis = moments.eigenvectors().col(2);
  if (m[2] - m[1] < alike && m[1] - m[0] > unlike) axis = moments.eigenvectors().col(0);
  if (!axis) return std::nullopt;
  for (int i = 1; i <= turns; ++i) {
    const double angle = 2.0 * std::numbers::pi * i * 0.381966;  // no two a simple part of a turn apart
    if (!gap(Eigen::AngleAxisd(angle, *axis).toRotationMatrix(), 0.0, 0.0, *axis).within) return std::nullopt;
  }
  return axis;
}

double ShapeComparison::lowest(const Eigen::Vector3d& up) const {
  double low = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& p : corners_) low = std::min(low, up.dot(p));
  return low;
}

/// \param slack_per_radius what is added to the tolerance for each metre from the axis through the centre
/// along `up`.
ShapeComparison::Gap ShapeComparison::gap(const Eigen::Matrix3d& turn, double lift, double slack_per_radius,
                                          const Eigen::Vector3d& up) const {
  const auto most_beyond =
      static_cast<std::size_t>((1.0 - share_within) * static_cast<double>(probes_.size()));
  std::size_t beyond = 0;
  double sum = 0.0;
  for (const Eigen::Vector3d& p : probes_) {
    const double distance = tree_->distance(turn * p + lift * up);
    const double slack = slack_per_radius * p.norm() + tree_->error;
    sum += distance;
    if (distance > farthest_of_tolerance * tolerance_ + slack) return {};
    if (distance > tolerance_ + slack && ++beyond > most_beyond) return {};
  }
  return {true, sum / static_cast<double>(probes_.size())};
}

bool ShapeComparison::equal_ups(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const {
  constexpr int yaws = 72, refinements = 7;
  constexpr double step = 2.0 * std::numbers::pi / yaws;
  // The heights of the centre above the plane: no turn on the plane changes them.
  const double lift = lowest(b) - lowest(a);
  if (std::abs(lift) > tolerance_) return false;
  const auto from_axis = [&](const Eigen::Vector3d& up) {
    return std::atan2(up.cross(*axis_).norm(), up.dot(*axis_));
  };
  if (axis_ && std::abs(from_axis(a) - from_axis(b)) * radius_ <= tolerance_) return true;
  // Turned by the smallest turn first: it is the one that takes sides of a solid of revolution to each other.
  const Eigen::Matrix3d b_from_a = Eigen::Quaterniond::FromTwoVectors(a, b).toRotationMatrix();
  const auto at = [&](double yaw, double slack) {
    return gap(Eigen::AngleAxisd(yaw, b) * b_from_a, lift, slack, b);
  };
  if (at(0.0, 0.0).within) return true;
  for (int i = 0; i < yaws; ++i) {
    if (!at(i * step, 0.5 * step).within) continue;
    // The best yaw within half a step, by cutting the interval's outer thirds off in turn.
    double low = (i - 0.5) * step, high = (i + 0.5) * step;
    const auto mean = [&](double yaw) { return at(yaw, step).mean; };
    for (int r = 0; r < refinements; ++r) {
      const double third = (high - low) / 3.0;
      if (mean(low + third) < mean(high - third))
        high -= third;
      else
        low += third;
    }
    if (at(0.5 * (low + high), 0.0).within) return true;
  }
  return false;
}

}  // namespace perch
