#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace perch {

/// How clouds are prepared and described. The same for training and recognition.
struct DescriptorSettings {
  double voxel = 0.003;              ///< edge of the voxels that clouds are thinned to, metres (PERCH: 3 mm)
  double smoothing_radius = 0.01;    ///< of the points that moving least squares fits a surface to, metres
  double upsampling_radius = 0.002;  ///< around each point the fitted surface is sampled so far, metres,
  double upsampling_step = 0.001;    ///< at this step, metres
  double normal_radius = 0.009;      ///< of the points that a normal is estimated from, metres
  double largest_curvature = 0.035;  ///< points of more curvature belong to no smooth region
  double largest_bend = 0.13;        ///< between the normals of neighbours in a smooth region, radians
  double region_spread = 2.5;        ///< normals of a region lie within this times largest_bend of their mean
  double region_gap = 0.009;         ///< between neighbours in a smooth region, metres
  int least_region = 50;             ///< points of a smooth region, at least
  bool normalized = true;            ///< histograms are shares of the points rather than counts

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// One histogram of a cloud, with the reference frame that it is relative to.
struct CloudDescriptor {
  std::array<float, 308> histogram{};  ///< not negative
  /// The histogram is of a smooth region's reference frame. Otherwise the cloud has no smooth region: a plain
  /// viewpoint feature histogram, whose frame is made of the line of sight and of what is up.
  bool of_region = false;
  Eigen::Affine3d frame_from_cloud = Eigen::Affine3d::Identity();  ///< an isometry, perhaps a reflection
};

/// The largest clusters of a cloud, largest first; at most `count`. \param points camera frame, metres.
/// \param tolerance clusters lie farther than this apart, metres. \param least points of a cluster, after
/// thinning.
std::vector<std::vector<Eigen::Vector3f>> largest_clusters(const std::vector<Eigen::Vector3f>& points,
                                                           std::size_t count, double tolerance, int least,
                                                           double voxel);

/// OUR-CVFH (Aldoma, Tombari, Rusu and Vincze, "OUR-CVFH: Oriented, Unique and Repeatable Clustered Viewpoint
/// Feature Histogram for Object Recognition and 6DOF Pose Estimation", DAGM 2012), by PCL: the cloud is
/// smoothed and upsampled by moving least squares, thinned to voxels and described once for each reference
/// frame of each of its smooth regions. Nothing for a cloud of fewer than a dozen voxels.
/// \param points camera frame, metres, one cluster. \param up of the world, camera frame.
std::vector<CloudDescriptor> describe_cloud(const std::vector<Eigen::Vector3f>& points,
                                            const Eigen::Vector3d& up, const DescriptorSettings& settings);

/// Name and version of the library that computes the descriptors; others may differ in detail.
std::string descriptor_library();

}  // namespace perch
