#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <nanoflann.hpp>
#include <vector>

namespace perch {

/// The exact nearest of some points, by a k-d tree: what the look-up tables stand in for.
class KdTree {
 public:
  /// Keeps a reference.
  explicit KdTree(const std::vector<Eigen::Vector3f>& points)
      : points_{points}, tree_(3, points_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {
    tree_.buildIndex();
  }
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  struct Neighbour {
    std::size_t number = 0;
    float squared_distance = 0.0F;
  };
  /// Of at least one point.
  Neighbour nearest(const Eigen::Vector3f& query) const {
    Neighbour neighbour;
    nanoflann::KNNResultSet<float> result(1);
    result.init(&neighbour.number, &neighbour.squared_distance);
    tree_.findNeighbors(result, query.data(), nanoflann::SearchParams());
    return neighbour;
  }

 private:
  struct Points {
    const std::vector<Eigen::Vector3f>& all;
    std::size_t kdtree_get_point_count() const { return all.size(); }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const {
      return all[i][static_cast<Eigen::Index>(axis)];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3,
                                                   std::size_t>;

  Points points_;
  Tree tree_;
};

}  // namespace perch
