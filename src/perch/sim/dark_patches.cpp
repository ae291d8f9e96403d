#include "perch/sim/dark_patches.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// A sum of waves in random directions, about standard normal at every point.
class RandomField {
 public:
  RandomField(double length, std::uint64_t seed) {
    constexpr std::size_t waves = 64;
    Random random(seed);
    for (std::size_t i = 0; i < waves; ++i) {
      Wave wave;
      for (int axis = 0; axis < 3; ++axis) wave.frequency[axis] = random.normal() / length;
      wave.phase = random.uniform(0.0, 2.0 * std::numbers::pi);
      waves_.push_back(wave);
    }
  }

  double at(const Eigen::Vector3d& p) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::cos(wave.frequency.dot(p) + wave.phase);
    return sum;
  }

 private:
  struct Wave {
    Eigen::Vector3d frequency = Eigen::Vector3d::Zero();  ///< radians a metre
    double phase = 0.0;
  };
  std::vector<Wave> waves_;
};

}  // namespace

Image<std::uint8_t> dark_patches(const DepthImage& ideal, const Intrinsics& intrinsics,
                                 const Image<std::uint16_t>& may_be, double share, double size,
                                 std::uint64_t seed) {
  Image<std::uint8_t> dark(ideal.width(), ideal.height(), 0);
  if (share <= 0.0) return dark;
  const RandomField field(size / std::numbers::pi, seed);
  const RaySlopes rays(intrinsics);
  std::vector<std::pair<double, std::size_t>> values;
  for (int v = 0; v < ideal.height(); ++v)
    for (int u = 0; u < ideal.width(); ++u)
      if (ideal(u, v) > 0.0F && may_be(u, v) != 0)
        values.emplace_back(field.at(rays.point(u, v, ideal(u, v)).cast<double>()), ideal.index(u, v));
  const auto count = static_cast<std::ptrdiff_t>(std::llround(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + count, values.end(), std::greater<>());
  for (auto value = values.begin(); value != values.begin() + count; ++value) dark[value->second] = 1;
  return dark;
}

}  // namespace perch
