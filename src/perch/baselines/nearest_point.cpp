#include "perch/baselines/nearest_point.hpp"

#include <cstddef>
#include <nanoflann.hpp>
#include <utility>

namespace perch {
struct NearestPoint::Tree {
  /// As nanoflann wants to see it.
  struct Cloud {
    std::vector<Eigen::Vector3f> points;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const {
      return points[i][static_cast<Eigen::Index>(axis)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Index = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3>;

  explicit Tree(std::vector<Eigen::Vector3f> points) : cloud{std::move(points)}, index(3, cloud) {}

  Cloud cloud;
  Index index;
};

NearestPoint::NearestPoint(std::vector<Eigen::Vector3f> cloud)
    : tree_(std::make_unique<const Tree>(std::move(cloud))) {}

NearestPoint::~NearestPoint() = default;

float NearestPoint::squared_distance(const Eigen::Vector3f& from) const {
  std::size_t number = 0;
  float squared = 0.0F;
  nanoflann::KNNResultSet<float> nearest(1);
  nearest.init(&number, &squared);
  tree_->index.findNeighbors(nearest, from.data(), nanoflann::SearchParams());
  return squared;
}

}  // namespace perch
