#include "perch/observation/extent.hpp"

#include <algorithm>
#include <vector>

namespace perch {

double lowest_height(const Observation& observation) {
  std::vector<double> heights;
  heights.reserve(observation.size());
  for (const Eigen::Vector3f& p : observation.points())
    heights.push_back((observation.camera().world_from_camera * p.cast<double>()).z());
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 200);
  std::nth_element(heights.begin(), low, heights.end());
  return *low;
}

Eigen::AlignedBox2d footprint(const Observation& observation) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector3f& p : observation.points())
    box.extend((observation.camera().world_from_camera * p.cast<double>()).head<2>());
  return box;
}

}  // namespace perch
