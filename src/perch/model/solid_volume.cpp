#include "perch/model/solid_volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "perch/model/distance_transform.hpp"

namespace perch {
namespace {

constexpr float no_distance = std::numeric_limits<float>::infinity();
constexpr float voxels_across = 72.0F;  // of the longest side; a compromise of memory (0.4 MB) and sharpness
constexpr float smallest_voxel = 0.0005F, largest_voxel = 0.01F;
constexpr std::size_t most_interior_samples = 2000;
const float sqrt3 = std::sqrt(3.0F);

/// +1 or -1 where the vertical line at (x, y) crosses the triangle (by the sense of its normal), else 0.
/// Triangles that share an edge count the line on it exactly once between them.
int vertical_crossing(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c, float x,
                      float y, float& z) {
  const auto edge = [&](const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
    const bool flipped = q.x() < p.x() || (q.x() == p.x() && q.y() < p.y());
    const Eigen::Vector3f &s = flipped ? q : p, &t = flipped ? p : q;
    const double e = (static_cast<double>(t.x()) - s.x()) * (static_cast<double>(y) - s.y()) -
                     (static_cast<double>(t.y()) - s.y()) * (static_cast<double>(x) - s.x());
    return flipped ? -e : e;
  };
  // On the edge itself: belongs to the side that sees it run up, or right.
  const auto owns = [](const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
    return q.y() > p.y() || (q.y() == p.y() && q.x() > p.x());
  };
  const double e0 = edge(a, b), e1 = edge(b, c), e2 = edge(c, a);
  const auto inside = [&](double sense) {
    const auto side = [&](double e, const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
      return e * sense > 0.0 || (e == 0.0 && (owns(p, q) == (sense > 0.0)));
    };
    return side(e0, a, b) && side(e1, b, c) && side(e2, c, a);
  };
  const double area = e0 + e1 + e2;
  if (area == 0.0 || !inside(area > 0.0 ? 1.0 : -1.0)) return 0;
  z = static_cast<float>((e1 * a.z() + e2 * b.z() + e0 * c.z()) / area);
  return area > 0.0 ? 1 : -1;
}

}  // namespace

std::vector<Eigen::Vector3f> sample_surface(const Mesh& mesh, float spacing) {
  std::vector<Eigen::Vector3f> samples;
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.vertices[ia], &b = mesh.vertices[ib], &c = mesh.vertices[ic];
    const float longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = std::max(1, static_cast<int>(std::ceil(longest / spacing)));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        samples.push_back(a + (b - a) * (static_cast<float>(i) / static_cast<float>(n)) +
                          (c - a) * (static_cast<float>(j) / static_cast<float>(n)));
  }
  return samples;
}

SolidVolume::SolidVolume(const Mesh& mesh, double margin) : solid_(is_closed(mesh)) {
  const Eigen::AlignedBox3f box = mesh.bounds();
  voxel_ = std::clamp(box.sizes().maxCoeff() / voxels_across, smallest_voxel, largest_voxel);
  half_diagonal_ = 0.5F * sqrt3 * voxel_;
  const float pad = static_cast<float>(margin) + 2.0F * voxel_;
  reach_ = pad;
  origin_ = box.min() - Eigen::Vector3f::Constant(pad);
  size_ = ((box.sizes().array() + 2.0F * pad) / voxel_).ceil().matrix().cast<int>() + Eigen::Vector3i::Ones();

  field_.assign(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                    static_cast<std::size_t>(size_.z()),
                no_distance);
  const float seed_spacing = 0.5F * voxel_;
  const auto voxel_of = [&](const Eigen::Vector3f& p) -> Eigen::Vector3i {
    return ((p - origin_) / voxel_).array().round().matrix().cast<int>();
  };
  // One sample a cell of twice a voxel's size is plenty for the collision test.
  const Eigen::Vector3i cells = size_ / 2 + Eigen::Vector3i::Ones();
  std::vector<char> sampled(static_cast<std::size_t>(cells.prod()), 0);
  for (const Eigen::Vector3f& p : sample_surface(mesh, seed_spacing)) {
    const Eigen::Vector3i seed = voxel_of(p);
    field_[index(seed.x(), seed.y(), seed.z())] = 0.0F;
    char& taken = sampled[static_cast<std::size_t>(((seed.z() / 2) * cells.y() + seed.y() / 2) * cells.x() +
                                                   seed.x() / 2)];
    if (!std::exchange(taken, 1)) samples_.push_back(p);
  }
  // A surface point has a seed's sample within seed_spacing / sqrt(3), and that one shares a cell of two
  // voxels' width with the sample that was kept.
  sample_radius_ = seed_spacing / sqrt3 + 2.0F * sqrt3 * voxel_;
  field_error_ = half_diagonal_ + seed_spacing / sqrt3;

  squared_distance_transform(field_, size_, SerialExecutor());
  std::vector<char> inside(field_.size(), 0);
  if (solid_) mark_inside(mesh, inside);
  for (std::size_t i = 0; i < field_.size(); ++i) {
    const float distance = voxel_ * std::sqrt(field_[i]);
    field_[i] = inside[i] ? distance : -distance;
    greatest_depth_ = std::max(greatest_depth_, field_[i] - field_error_);
  }
  sample_interior(inside);
}

void SolidVolume::mark_inside(const Mesh& mesh, std::vector<char>& inside) const {
  // Winding number along vertical lines: what lies between a crossing downwards and one upwards is inside.
  struct Crossing {
    float z;
    int sense;
  };
  std::vector<std::vector<Crossing>> columns(static_cast<std::size_t>(size_.x()) *
                                             static_cast<std::size_t>(size_.y()));
  for (const auto& [ia, ib, ic] : mesh.triangles) {
    const Eigen::Vector3f &a = mesh.vertices[ia], &b = mesh.vertices[ib], &c = mesh.vertices[ic];
    const Eigen::Vector3f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const int i0 = static_cast<int>(std::floor((low.x() - origin_.x()) / voxel_)),
              i1 = static_cast<int>(std::ceil((high.x() - origin_.x()) / voxel_));
    const int j0 = static_cast<int>(std::floor((low.y() - origin_.y()) / voxel_)),
              j1 = static_cast<int>(std::ceil((high.y() - origin_.y()) / voxel_));
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i) {
        const Eigen::Vector3f q = centre(i, j, 0);
        float z = 0.0F;
        if (const int sense = vertical_crossing(a, b, c, q.x(), q.y(), z))
          columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.x()) +
                  static_cast<std::size_t>(i)]
              .push_back({z, sense});
      }
  }
  for (int j = 0; j < size_.y(); ++j)
    for (int i = 0; i < size_.x(); ++i) {
      auto& column = columns[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.x()) +
                             static_cast<std::size_t>(i)];
      std::sort(column.begin(), column.end(), [](const Crossing& p, const Crossing& q) { return p.z < q.z; });
      int winding = 0;
      std::size_t next = 0;
      for (int k = 0; k < size_.z(); ++k) {
        for (; next < column.size() && column[next].z <= centre(i, j, k).z(); ++next)
          winding += column[next].sense;
        inside[index(i, j, k)] = winding != 0;
      }
    }
}

void SolidVolume::sample_interior(const std::vector<char>& inside) {
  const auto voxels = static_cast<std::size_t>(std::count(inside.begin(), inside.end(), 1));
  // Every n-th inside voxel in storage order: as even as the voxels are, and always the same.
  const std::size_t every = 1 + voxels / most_interior_samples;
  std::size_t number = 0;
  for (int k = 0; k < size_.z(); ++k)
    for (int j = 0; j < size_.y(); ++j)
      for (int i = 0; i < size_.x(); ++i)
        if (inside[index(i, j, k)] && number++ % every == 0) interior_.push_back(centre(i, j, k));
}

bool SolidVolume::find_voxel(const Eigen::Vector3f& p, std::size_t& voxel, float& distance) const {
  if (field_.empty()) return false;
  // The nearest centre's numbers, compared before they are made integers, which may not hold them.
  const Eigen::Array3f nearest = (p - origin_).array() / voxel_ + 0.5F;
  if (!((nearest >= 0.5F).all() && (nearest < size_.array().cast<float>()).all())) return false;
  const int i = static_cast<int>(nearest.x()), j = static_cast<int>(nearest.y()),
            k = static_cast<int>(nearest.z());
  voxel = index(i, j, k);
  distance = (p - centre(i, j, k)).norm();
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
