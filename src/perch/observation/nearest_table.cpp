#include "perch/observation/nearest_table.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace perch {
namespace {

constexpr float finest_cell = 0.005F;  // metres; about delta, below which noise rules anyway
constexpr float most_cells = 4'000'000.0F;

}  // namespace

NearestTable::NearestTable(const Observation& observation, double reach, const Executor& executor,
                           const StopCondition& stop) {
  const Eigen::Isometry3f world_from_camera = observation.camera().world_from_camera.cast<float>();
  Eigen::AlignedBox3f box;
  std::vector<Eigen::Vector3f> all;
  all.reserve(observation.size());
  for (const Eigen::Vector3f& p : observation.points()) {
    all.push_back(world_from_camera * p);
    box.extend(all.back());
  }
  const float pad = static_cast<float>(reach);
  const Eigen::Vector3f extent = box.sizes() + Eigen::Vector3f::Constant(2.0F * pad + finest_cell);
  cell_ = std::max(finest_cell, std::cbrt(extent.prod() / most_cells));
  origin_ = box.min() - Eigen::Vector3f::Constant(pad);
  size_ = (extent / cell_).array().ceil().matrix().cast<int>();
  nearest_.assign(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()) *
                      static_cast<std::size_t>(size_.z()),
                  -1);
  const auto centre = [&](int i, int j, int k) -> Eigen::Vector3f {
    return origin_ +
           cell_ * (Eigen::Vector3f(static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)) +
                    Eigen::Vector3f::Constant(0.5F));
  };

  // One point a cell stands for its cell: the one nearest to the centre. Sorted by slab of cells.
  struct Seed {
    Eigen::Vector3i cell;
    std::int32_t point;
  };
  std::vector<Seed> seeds;
  for (const Eigen::Vector3f& p : all) {
    const Eigen::Vector3i c = ((p - origin_) / cell_)
                                  .array()
                                  .floor()
                                  .matrix()
                                  .cast<int>()
                                  .cwiseMax(0)
                                  .cwiseMin(size_ - Eigen::Vector3i::Ones());
    std::int32_t& holder = nearest_[index(c.x(), c.y(), c.z())];
    const Eigen::Vector3f middle = centre(c.x(), c.y(), c.z());
    if (holder < 0) {
      holder = static_cast<std::int32_t>(points_.size());
      points_.push_back(p);
      seeds.push_back({c, holder});
    } else if ((p - middle).squaredNorm() <
               (points_[static_cast<std::size_t>(holder)] - middle).squaredNorm()) {
      points_[static_cast<std::size_t>(holder)] = p;
    }
  }
  std::stable_sort(seeds.begin(), seeds.end(),
                   [](const Seed& a, const Seed& b) { return a.cell.z() < b.cell.z(); });

  const int radius = static_cast<int>(std::ceil(pad / cell_));
  if (!executor.for_each(
          static_cast<std::size_t>(size_.z()),
          [&](std::size_t slab, std::size_t) {
            const int k = static_cast<int>(slab);
            std::vector<float> best(static_cast<std::size_t>(size_.x()) * static_cast<std::size_t>(size_.y()),
                                    std::numeric_limits<float>::infinity());
            auto seed = std::lower_bound(seeds.begin(), seeds.end(), k - radius,
                                         [](const Seed& s, int z) { return s.cell.z() < z; });
            for (; seed != seeds.end() && seed->cell.z() <= k + radius; ++seed) {
              const Eigen::Vector3f& p = points_[static_cast<std::size_t>(seed->point)];
              const int j0 = std::max(0, seed->cell.y() - radius),
                        j1 = std::min(size_.y() - 1, seed->cell.y() + radius);
              const int i0 = std::max(0, seed->cell.x() - radius),
                        i1 = std::min(size_.x() - 1, seed->cell.x() + radius);
              for (int j = j0; j <= j1; ++j)
                for (int i = i0; i <= i1; ++i) {
                  const float distance = (centre(i, j, k) - p).squaredNorm();
                  float& least = best[static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.x()) +
                                      static_cast<std::size_t>(i)];
                  if (distance < least) {
                    least = distance;
                    nearest_[index(i, j, k)] = seed->point;
                  }
                }
            }
          },
          stop))
    throw Interrupted();
}

const Eigen::Vector3f* NearestTable::lookup(const Eigen::Vector3f& world) const {
  const Eigen::Vector3f scaled = (world - origin_) / cell_;
  if (!(scaled.x() >= 0.0F && scaled.y() >= 0.0F && scaled.z() >= 0.0F)) return nullptr;
  if (!(scaled.x() < static_cast<float>(size_.x()) && scaled.y() < static_cast<float>(size_.y()) &&
        scaled.z() < static_cast<float>(size_.z())))
    return nullptr;
  const std::int32_t point = nearest_[index(static_cast<int>(scaled.x()), static_cast<int>(scaled.y()),
                                            static_cast<int>(scaled.z()))];
  return point < 0 ? nullptr : &points_[static_cast<std::size_t>(point)];
}

}  // namespace perch
