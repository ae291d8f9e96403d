#include "perch/model/solid_volume.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <numeric>

#include "perch/core/instruction_set.hpp"
#include "perch/model/distance_transform.hpp"
#include "perch/model/surface_samples.hpp"
#include "perch/model/winding_numbers.hpp"

namespace perch {
namespace {

constexpr float no_distance = std::numeric_limits<float>::infinity();
constexpr float voxels_across = 72.0F;  // of the longest side; a compromise of memory (0.4 MB) and sharpness
constexpr float smallest_voxel = 0.0005F, largest_voxel = 0.01F;
constexpr std::size_t most_interior_samples = 2000;
const float sqrt3 = std::sqrt(3.0F);

}  // namespace
}  // namespace perch

#define PERCH_KERNELS "perch/model/solid_volume.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

SolidVolume::SolidVolume(const Mesh& mesh, double margin, const Executor& executor, const StopCondition& stop)
    : solid_(is_closed(mesh)) {
  const Eigen::AlignedBox3f box = mesh.bounds();
  grid_.voxel = std::clamp(box.sizes().maxCoeff() / voxels_across, smallest_voxel, largest_voxel);
  half_diagonal_ = 0.5F * sqrt3 * grid_.voxel;
  const float pad = static_cast<float>(margin) + 2.0F * grid_.voxel;
  reach_ = pad;
  grid_.origin = box.min() - Eigen::Vector3f::Constant(pad);
  grid_.size = ((box.sizes().array() + 2.0F * pad) / grid_.voxel).ceil().matrix().cast<int>() +
               Eigen::Vector3i::Ones();

  const float seed_spacing = 0.5F * grid_.voxel;
  field_.assign(grid_.voxels(), no_distance);
  // One sample a cell of twice a voxel's size is plenty for the collision test.
  samples_ = mark_surface(mesh, seed_spacing, grid_, field_, executor, stop);
  // A surface point has a seed's sample within seed_spacing / sqrt(3), and that one shares a cell of two
  // voxels' width with the sample that was kept.
  sample_radius_ = seed_spacing / sqrt3 + 2.0F * sqrt3 * grid_.voxel;
  field_error_ = half_diagonal_ + seed_spacing / sqrt3;

  squared_distance_transform(field_, grid_.size, executor, stop);
  const std::vector<std::uint16_t> winding =
      solid_ ? winding_numbers(mesh, grid_, executor, stop) : std::vector<std::uint16_t>(grid_.voxels(), 0);
  const std::size_t plane = grid_.plane();
  std::vector<float> deepest(grid_.planes());
  const auto sign_plane = [&](std::size_t k, std::size_t) {
    deepest[k] =
        PERCH_CALL(sign_distances, field_.data() + k * plane, winding.data() + k * plane, plane, grid_.voxel);
  };
  if (!executor.for_each(grid_.planes(), sign_plane, stop)) throw Interrupted();
  greatest_depth_ = std::max(0.0F, *std::max_element(deepest.begin(), deepest.end()) - field_error_);
  if (solid_) sample_interior(winding);
}

void SolidVolume::sample_interior(const std::vector<std::uint16_t>& winding) {
  const auto inside = [](std::uint16_t number) { return number != 0; };
  const std::size_t width = static_cast<std::size_t>(grid_.size.x());
  std::vector<std::size_t> of_row(grid_.rows());
  for (std::size_t row = 0; row < of_row.size(); ++row) {
    const auto first = winding.begin() + static_cast<std::ptrdiff_t>(row * width);
    of_row[row] =
        static_cast<std::size_t>(std::count_if(first, first + static_cast<std::ptrdiff_t>(width), inside));
  }
  const std::size_t voxels = std::accumulate(of_row.begin(), of_row.end(), std::size_t{0});
  // Every n-th inside voxel in storage order: as even as the voxels are, and always the same.
  const std::size_t every = 1 + voxels / most_interior_samples;
  std::size_t skip = 0;  // how many come before the next
  for (int k = 0; k < grid_.size.z(); ++k)
    for (int j = 0; j < grid_.size.y(); ++j) {
      const std::size_t row = grid_.index(0, j, k);
      if (skip >= of_row[row / width]) {
        skip -= of_row[row / width];
        continue;
      }
      for (int i = 0; i < grid_.size.x(); ++i) {
        if (!inside(winding[row + static_cast<std::size_t>(i)])) continue;
        if (skip == 0) interior_.push_back(grid_.centre(i, j, k));
        skip = skip == 0 ? every - 1 : skip - 1;
      }
    }
}

bool SolidVolume::find_voxel(const Eigen::Vector3f& p, std::size_t& voxel, float& distance) const {
  if (field_.empty()) return false;
  // The nearest centre's numbers, compared before they are made integers, which may not hold them.
  const Eigen::Array3f nearest = (p - grid_.origin).array() / grid_.voxel + 0.5F;
  if (!((nearest >= 0.5F).all() && (nearest < grid_.size.array().cast<float>()).all())) return false;
  const int i = static_cast<int>(nearest.x()), j = static_cast<int>(nearest.y()),
            k = static_cast<int>(nearest.z());
  voxel = grid_.index(i, j, k);
  distance = (p - grid_.centre(i, j, k)).norm();
  return true;
}

float SolidVolume::signed_distance(const Eigen::Vector3f& p) const {
  std::size_t voxel = 0;
  float distance = 0.0F;
  return find_voxel(p, voxel, distance) ? field_[voxel] : -no_distance;
}

float SolidVolume::depth_lower_bound(const Eigen::Vector3f& p) const {
  std::size_t voxel = 0;
  float distance = 0.0F;
  if (!solid_ || !find_voxel(p, voxel, distance) || field_[voxel] <= 0.0F) return -no_distance;
  const float bound = field_[voxel] - field_error_ - distance;
  return bound > 0.0F ? bound : -no_distance;
}

}  // namespace perch
