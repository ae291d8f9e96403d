#include "perch/eval/pose_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <numbers>

namespace perch {
namespace {

using Points = Eigen::Matrix3Xd;

Points placed(Vertices vertices, const Eigen::Isometry3d& pose) {
  Points points(3, static_cast<Eigen::Index>(vertices.size()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    points.col(i) = pose * vertices[static_cast<std::size_t>(i)].cast<double>();
  return points;
}

/// Pixel of each point; all lie in front of the camera.
Eigen::Matrix2Xd projected(const Points& points, const Intrinsics& k) {
  Eigen::Matrix2Xd pixels(2, points.cols());
  pixels.row(0) = (k.fx * points.row(0).array() / points.row(2).array() + k.cx).matrix();
  pixels.row(1) = (k.fy * points.row(1).array() / points.row(2).array() + k.cy).matrix();
  return pixels;
}

/// The largest squared distance of two columns of the same number; no less than `enough` where it is at
/// least that.
template <typename Matrix>
double largest_squared_distance(const Matrix& a, const Matrix& b, double enough) {
  double largest = 0.0;
  for (Eigen::Index i = 0; i < a.cols() && largest < enough; ++i)
    largest = std::max(largest, (a.col(i) - b.col(i)).squaredNorm());
  return largest;
}

/// The least over the symmetries of the largest distance between what `image` makes of both poses.
template <typename Image>
double largest_distance(Vertices vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth,
                        const std::vector<Eigen::Isometry3d>& symmetries, const Image& image) {
  const auto estimated = image(placed(vertices, estimate));
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Isometry3d& symmetry : symmetries)
    least = std::min(least,
                     largest_squared_distance(estimated, image(placed(vertices, truth * symmetry)), least));
  return std::sqrt(least);
}

}  // namespace

double diameter(Vertices vertices) {
  // Outermost first: two vertices are no farther apart than their distances from the middle together.
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3f& v : vertices) bounds.extend(v.cast<double>());
  const Eigen::Vector3d middle = bounds.center();
  struct Vertex {
    double radius;
    Eigen::Vector3d at;
  };
  std::vector<Vertex> sorted;
  for (const Eigen::Vector3f& v : vertices)
    sorted.push_back({(v.cast<double>() - middle).norm(), v.cast<double>()});
  std::sort(sorted.begin(), sorted.end(),
            [](const Vertex& a, const Vertex& b) { return a.radius > b.radius; });
  double largest = 0.0;
  for (std::size_t i = 0; i < sorted.size() && 2.0 * sorted[i].radius > largest; ++i)
    for (std::size_t j = i + 1; j < sorted.size() && sorted[i].radius + sorted[j].radius > largest; ++j)
      largest = std::max(largest, (sorted[i].at - sorted[j].at).norm());
  return largest;
}

double average_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                        const Eigen::Isometry3d& truth) {
  return (placed(vertices, estimate) - placed(vertices, truth)).colwise().norm().mean();
}

double average_nearest_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                                const Eigen::Isometry3d& truth) {
  // A rigid motion changes no distance: the tree is built in the model's frame.
  const Eigen::Matrix<double, Eigen::Dynamic, 3> model =
      placed(vertices, Eigen::Isometry3d::Identity()).transpose();
  const Points sought = placed(vertices, estimate.inverse() * truth);
  const nanoflann::KDTreeEigenMatrixAdaptor<Eigen::Matrix<double, Eigen::Dynamic, 3>, 3> tree(3, model);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < sought.cols(); ++i) {
    const Eigen::Vector3d point = sought.col(i);
    Eigen::Index nearest = 0;
    double squared = 0.0;
    tree.index->knnSearch(point.data(), 1, &nearest, &squared);
    sum += std::sqrt(squared);
  }
  return sum / static_cast<double>(sought.cols());
}

std::vector<Eigen::Isometry3d> symmetry_turns(const Symmetry& symmetry) {
  constexpr int of_continuous = 315;  // the whole part of pi / 0.01, and one more
  const int n = symmetry.is_continuous() ? of_continuous : symmetry.fold();
  std::vector<Eigen::Isometry3d> turns;
  for (int i = 0; i < n; ++i)
    turns.emplace_back(Eigen::AngleAxisd(2.0 * std::numbers::pi * i / n, Eigen::Vector3d::UnitZ()));
  return turns;
}

double largest_surface_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                                const Eigen::Isometry3d& truth,
                                const std::vector<Eigen::Isometry3d>& symmetries) {
  return largest_distance(vertices, estimate, truth, symmetries, [](Points points) { return points; });
}

double largest_projection_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                                   const Eigen::Isometry3d& truth,
                                   const std::vector<Eigen::Isometry3d>& symmetries,
                                   const Intrinsics& intrinsics) {
  const auto in_front = [&](const Points& points) { return points.row(2).minCoeff() > 0.0; };
  // Symmetries about z move a vertex to where another is, but not exactly: each is looked at.
  if (!in_front(placed(vertices, estimate)) ||
      !std::all_of(symmetries.begin(), symmetries.end(), [&](const Eigen::Isometry3d& symmetry) {
        return in_front(placed(vertices, truth * symmetry));
      }))
    return std::numeric_limits<double>::infinity();
  return largest_distance(vertices, estimate, truth, symmetries,
                          [&](const Points& points) { return projected(points, intrinsics); });
}

}  // namespace perch
