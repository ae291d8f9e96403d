#include "perch/baselines/cloud_descriptors.hpp"

#include <fmt/format.h>
#include <pcl/console/print.h>
#include <pcl/features/normal_3d.h>
#include <pcl/features/our_cvfh.h>
#include <pcl/features/vfh.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/pcl_config.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/surface/mls.h>

#include <algorithm>
#include <cmath>

#include "perch/core/error.hpp"

namespace perch {

void DescriptorSettings::check() const {
  const auto in_range = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InvalidSetting(
          fmt::format("ourcvfh.{} is {}; it must lie between {} and {}", field, value, low, high));
  };
  in_range("voxel", voxel, 1e-4, 0.1);
  in_range("smoothing_radius", smoothing_radius, 1e-4, 0.1);
  in_range("upsampling_radius", upsampling_radius, 1e-4, smoothing_radius);
  in_range("upsampling_step", upsampling_step, upsampling_radius / 20.0, upsampling_radius);
  in_range("normal_radius", normal_radius, voxel, 0.1);
  in_range("largest_curvature", largest_curvature, 0.0, 1.0);
  in_range("largest_bend", largest_bend, 0.0, 3.15);
  in_range("region_spread", region_spread, 0.1, 100.0);
  in_range("region_gap", region_gap, voxel, 0.1);
  in_range("least_region", least_region, 3, 1e6);
}

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Tree = pcl::search::KdTree<pcl::PointXYZ>;

/// PCL warns of what is usual here, such as clouds without smooth regions.
void silence_library() {
  static const bool done = [] {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    return true;
  }();
  static_cast<void>(done);
}

Cloud::Ptr cloud_of(const std::vector<Eigen::Vector3f>& points) {
  const Cloud::Ptr cloud(new Cloud);
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->push_back(pcl::PointXYZ(p.x(), p.y(), p.z()));
  return cloud;
}

Cloud::Ptr thinned(const Cloud::Ptr& cloud, double voxel) {
  const Cloud::Ptr thin(new Cloud);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(cloud);
  grid.setLeafSize(Eigen::Vector4f::Constant(static_cast<float>(voxel)));
  grid.filter(*thin);
  return thin;
}

Cloud::Ptr upsampled(const Cloud::Ptr& cloud, const DescriptorSettings& settings) {
  const Cloud::Ptr up(new Cloud);
  using Fit = pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointXYZ>;
  Fit fit;
  fit.setInputCloud(cloud);
  fit.setSearchMethod(pcl::make_shared<Tree>(false));
  fit.setSearchRadius(settings.smoothing_radius);
  fit.setPolynomialOrder(2);
  fit.setUpsamplingMethod(Fit::SAMPLE_LOCAL_PLANE);
  fit.setUpsamplingRadius(settings.upsampling_radius);
  fit.setUpsamplingStepSize(settings.upsampling_step);
  fit.setCacheMLSResults(false);
  fit.setNumberOfThreads(1);
  fit.process(*up);
  std::erase_if(up->points, [](const pcl::PointXYZ& p) { return !pcl::isFinite(p); });
  up->width = static_cast<std::uint32_t>(up->points.size());
  up->height = 1;
  up->is_dense = true;
  return up;
}

/// Points and their normals, which look towards the camera; points without a normal are dropped.
Normals::Ptr estimate_normals(Cloud& cloud, double radius) {
  const Normals::Ptr normals(new Normals);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(cloud.makeShared());
  estimation.setSearchMethod(pcl::make_shared<Tree>(false));
  estimation.setRadiusSearch(radius);
  estimation.compute(*normals);
  Cloud points;
  Normals kept;
  for (std::size_t i = 0; i < normals->size(); ++i) {
    if (!pcl::isFinite((*normals)[i])) continue;
    points.push_back(cloud[i]);
    kept.push_back((*normals)[i]);
  }
  cloud = std::move(points);
  *normals = std::move(kept);
  return normals;
}

/// A smooth part of a cloud: what of it looks about where it does on average.
struct Region {
  pcl::PointIndices points;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
};

/// Points of little curvature, their normals estimated anew without the rest, grown into regions.
std::vector<Region> smooth_regions(const Cloud::Ptr& cloud, const Normals& normals,
                                   const DescriptorSettings& settings) {
  const Cloud::Ptr flat(new Cloud);
  pcl::Indices in_cloud;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    if (!(normals[i].curvature <= settings.largest_curvature)) continue;
    flat->push_back((*cloud)[i]);
    in_cloud.push_back(static_cast<pcl::index_t>(i));
  }
  if (flat->size() < static_cast<std::size_t>(settings.least_region)) return {};
  Normals flat_normals;
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(flat);
  estimation.setSearchMethod(pcl::make_shared<Tree>(false));
  estimation.setRadiusSearch(settings.normal_radius);
  estimation.compute(flat_normals);
  const pcl::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::KdTreeFLANN<pcl::PointXYZ>);
  tree->setInputCloud(flat);
  std::vector<pcl::PointIndices> grown;
  pcl::extractEuclideanClusters(*flat, flat_normals, static_cast<float>(settings.region_gap), tree, grown,
                                settings.largest_bend, static_cast<unsigned>(settings.least_region));

  std::vector<Region> regions;
  const double least_cosine = std::cos(std::min(3.14, settings.region_spread * settings.largest_bend));
  for (const pcl::PointIndices& all : grown) {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();
    for (const pcl::index_t i : all.indices) mean += flat_normals[i].getNormalVector3fMap();
    mean.normalize();
    Region region;
    for (const pcl::index_t i : all.indices) {
      const Eigen::Vector3f normal = flat_normals[i].getNormalVector3fMap();
      if (!(static_cast<double>(mean.dot(normal)) > least_cosine)) continue;
      region.points.indices.push_back(in_cloud[static_cast<std::size_t>(i)]);
      region.normal += normal;
      region.centre += (*flat)[i].getVector3fMap();
    }
    // Fewer make no reference frame: PCL divides by their spread.
    if (region.points.indices.size() < static_cast<std::size_t>(settings.least_region)) continue;
    region.centre /= static_cast<float>(region.points.indices.size());
    region.normal.normalize();
    regions.push_back(std::move(region));
  }
  return regions;
}

/// What PCL does once it has the regions. Its own regions may be left with a single point, of which it makes
/// a reference frame that is no number, and then writes beside its histograms.
class RegionDescriptors : public pcl::OURCVFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> {
 public:
  using Signatures = pcl::PointCloud<pcl::VFHSignature308>;

  /// For each reference frame of each region its descriptor; one for the whole cloud where there is no
  /// region.
  Signatures describe(Cloud::Ptr cloud, const Normals::Ptr& normals, const std::vector<Region>& regions,
                      bool normalized) {
    pcl::VFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::VFHSignature308> whole;
    whole.setInputCloud(cloud);
    whole.setInputNormals(normals);
    whole.setSearchMethod(pcl::make_shared<Tree>(false));
    whole.setNormalizeBins(normalized);
    Signatures signatures;
    if (regions.empty()) {
      whole.compute(signatures);
      return signatures;
    }
    whole.setUseGivenNormal(true);
    whole.setUseGivenCentroid(true);
    std::vector<pcl::PointIndices> points;
    for (const Region& region : regions) {
      whole.setNormalToUse(region.normal);
      whole.setCentroidToUse(region.centre);
      Signatures one;
      whole.compute(one);
      signatures.push_back(one[0]);
      dominant_normals_.push_back(region.normal);
      centroids_dominant_orientations_.push_back(region.centre);
      points.push_back(region.points);
    }
    setNormalizeBins(normalized);
    computeRFAndShapeDistribution(cloud, signatures, points);
    return signatures;
  }
};

/// Origin in the middle, z towards the camera, x level.
Eigen::Affine3d sight_frame(const Cloud& cloud, const Eigen::Vector3d& up) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const pcl::PointXYZ& p : cloud) middle += p.getVector3fMap().cast<double>();
  middle /= static_cast<double>(cloud.size());
  const Eigen::Vector3d towards = -middle.normalized();
  Eigen::Vector3d level = up.cross(towards);
  if (level.norm() < 1e-6) level = Eigen::Vector3d::UnitX() - towards.x() * towards;
  level.normalize();
  Eigen::Affine3d cloud_from_frame = Eigen::Affine3d::Identity();
  cloud_from_frame.linear().col(0) = level;
  cloud_from_frame.linear().col(1) = towards.cross(level);
  cloud_from_frame.linear().col(2) = towards;
  cloud_from_frame.translation() = middle;
  return cloud_from_frame.inverse();
}

}  // namespace

std::vector<std::vector<Eigen::Vector3f>> largest_clusters(const std::vector<Eigen::Vector3f>& points,
                                                           std::size_t count, double tolerance, int least,
                                                           double voxel) {
  silence_library();
  const Cloud::Ptr thin = thinned(cloud_of(points), voxel);
  const Tree::Ptr tree(new Tree);
  tree->setInputCloud(thin);
  std::vector<pcl::PointIndices> found;
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setInputCloud(thin);
  extraction.setSearchMethod(tree);
  extraction.setClusterTolerance(tolerance);
  extraction.setMinClusterSize(least);
  extraction.extract(found);
  std::stable_sort(found.begin(), found.end(), [](const pcl::PointIndices& a, const pcl::PointIndices& b) {
    return a.indices.size() > b.indices.size();
  });
  found.resize(std::min(found.size(), count));
  // All the points of a cluster, not only those that the voxels leave: each goes with the voxel point
  // nearest.
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> cluster_of(thin->size(), none);
  for (std::size_t c = 0; c < found.size(); ++c)
    for (const pcl::index_t i : found[c].indices) cluster_of[static_cast<std::size_t>(i)] = c;
  std::vector<std::vector<Eigen::Vector3f>> clusters(found.size());
  pcl::Indices nearest(1);
  std::vector<float> squared(1);
  for (const Eigen::Vector3f& p : points) {
    if (tree->nearestKSearch(pcl::PointXYZ(p.x(), p.y(), p.z()), 1, nearest, squared) == 0) continue;
    const std::size_t cluster = cluster_of[static_cast<std::size_t>(nearest[0])];
    if (cluster != none) clusters[cluster].push_back(p);
  }
  return clusters;
}

std::vector<CloudDescriptor> describe_cloud(const std::vector<Eigen::Vector3f>& points,
                                            const Eigen::Vector3d& up, const DescriptorSettings& settings) {
  constexpr std::size_t least_points = 12;
  silence_library();
  if (points.size() < least_points) return {};
  const Cloud::Ptr cloud =
      thinned(upsampled(thinned(cloud_of(points), settings.voxel), settings), settings.voxel);
  if (cloud->size() < least_points) return {};
  const Normals::Ptr normals = estimate_normals(*cloud, settings.normal_radius);
  if (cloud->size() < least_points) return {};

  RegionDescriptors estimation;
  const pcl::PointCloud<pcl::VFHSignature308> signatures =
      estimation.describe(cloud, normals, smooth_regions(cloud, *normals, settings), settings.normalized);
  std::vector<Eigen::Matrix4f, Eigen::aligned_allocator<Eigen::Matrix4f>> frames;
  estimation.getTransforms(frames);

  std::vector<CloudDescriptor> descriptors;
  for (std::size_t i = 0; i < signatures.size(); ++i) {
    CloudDescriptor descriptor;
    std::copy(std::begin(signatures[i].histogram), std::end(signatures[i].histogram),
              descriptor.histogram.begin());
    descriptor.of_region = i < frames.size();
    descriptor.frame_from_cloud =
        descriptor.of_region ? Eigen::Affine3d(frames[i].cast<double>()) : sight_frame(*cloud, up);
    const auto finite = [](float value) { return std::isfinite(value); };
    if (std::all_of(descriptor.histogram.begin(), descriptor.histogram.end(), finite) &&
        descriptor.frame_from_cloud.matrix().allFinite())
      descriptors.push_back(descriptor);
  }
  return descriptors;
}

std::string descriptor_library() {
  return fmt::format("PCL {}", PCL_VERSION_PRETTY);
}

}  // namespace perch
