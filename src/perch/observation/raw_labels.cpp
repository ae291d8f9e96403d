#include "perch/observation/raw_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace perch {
namespace {

constexpr int least_continued =
    3;  // of eight neighbours; with fewer, a reading between two surfaces is mixed
constexpr double least_speck = 0.0001;  // square metres; a smaller group that hangs on nothing is no object
constexpr int least_group = 12;         // pixels
constexpr int growing_rounds = 12;      // pixels that a surface is followed below the first threshold
constexpr double faint = 0.4;           // of that threshold, down to which it is followed

constexpr std::array<std::pair<int, int>, 8> around{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

class Labeller {
 public:
  Labeller(const DepthImage& depth, const Intrinsics& intrinsics, const SupportPlane& plane)
      : depth_(depth),
        intrinsics_(intrinsics),
        rays_(intrinsics),
        plane_(plane),
        labels_(depth.width(), depth.height(), RawLabel::unknown),
        height_(depth.width(), depth.height(), 0.0F) {}

  Image<RawLabel> run(const std::function<bool(const Eigen::Vector3d&)>& in_reach,
                      const std::function<bool(const Eigen::Vector3d&)>& behind) {
    for (int v = 0; v < depth_.height(); ++v)
      for (int u = 0; u < depth_.width(); ++u) {
        const float z = depth_(u, v);
        if (!(z > 0.0F) || is_mixed(u, v)) continue;
        const Eigen::Vector3d p = rays_.point(u, v, z).cast<double>();
        height_(u, v) = static_cast<float>(plane_.above(p));
        if (height_(u, v) <= static_cast<float>(plane_tolerance(z)))
          labels_(u, v) = RawLabel::background;
        else if (in_reach(p))
          labels_(u, v) = RawLabel::object;
        else
          labels_(u, v) = behind(p) ? RawLabel::background : RawLabel::foreground;
      }
    follow_down();
    drop_specks();
    return std::move(labels_);
  }

 private:
  /// Depths of neighbours of one surface differ by less, metres: noise, and a slope of 60 degrees.
  double gap(double z) const { return 0.5 * plane_tolerance(z) + 2.0 * z / intrinsics_.fx * std::sqrt(3.0); }

  bool is_mixed(int u, int v) const {
    const double z = depth_(u, v), most = gap(z);
    int continued = 0;
    bool nearer = false, farther = false;
    for (const auto& [du, dv] : around) {
      if (!depth_.contains(u + du, v + dv)) continue;
      const double other = depth_(u + du, v + dv);
      if (!(other > 0.0)) continue;
      continued += std::abs(other - z) <= most;
      nearer = nearer || other < z - most;
      farther = farther || other > z + most;
    }
    return continued < least_continued && nearer && farther;
  }

  /// What is a little above the plane next to a part of an object is the object's foot.
  void follow_down() {
    for (int round = 0; round < growing_rounds; ++round) {
      std::vector<std::size_t> more;
      for (int v = 0; v < labels_.height(); ++v)
        for (int u = 0; u < labels_.width(); ++u) {
          if (labels_(u, v) != RawLabel::background) continue;
          const double z = depth_(u, v);
          if (height_(u, v) <= static_cast<float>(faint * plane_tolerance(z))) continue;
          const bool beside = std::any_of(around.begin(), around.end(), [&](const auto& step) {
            const int x = u + step.first, y = v + step.second;
            return labels_.contains(x, y) && labels_(x, y) == RawLabel::object &&
                   height_(x, y) >= height_(u, v) && std::abs(depth_(x, y) - z) <= gap(z);
          });
          if (beside) more.push_back(labels_.index(u, v));
        }
      if (more.empty()) return;
      for (const std::size_t i : more) labels_[i] = RawLabel::object;
    }
  }

  /// Groups of object pixels that are too small to be one.
  void drop_specks() {
    Image<std::uint8_t> met(labels_.width(), labels_.height(), 0);
    std::vector<std::pair<int, int>> group;
    for (int v0 = 0; v0 < labels_.height(); ++v0)
      for (int u0 = 0; u0 < labels_.width(); ++u0) {
        if (met(u0, v0) || labels_(u0, v0) != RawLabel::object) continue;
        group.assign(1, {u0, v0});
        met(u0, v0) = 1;
        double area = 0.0;
        for (std::size_t i = 0; i < group.size(); ++i) {
          const auto [u, v] = group[i];
          const double z = depth_(u, v);
          area += z * z / (intrinsics_.fx * intrinsics_.fy);
          for (const auto& [du, dv] : around) {
            const int x = u + du, y = v + dv;
            if (!labels_.contains(x, y) || met(x, y) || labels_(x, y) != RawLabel::object) continue;
            if (std::abs(depth_(x, y) - z) > 2.0 * gap(z)) continue;
            met(x, y) = 1;
            group.emplace_back(x, y);
          }
        }
        if (area >= least_speck && group.size() >= static_cast<std::size_t>(least_group)) continue;
        for (const auto& [u, v] : group) labels_(u, v) = RawLabel::unknown;
      }
  }

  const DepthImage& depth_;
  const Intrinsics& intrinsics_;
  const RaySlopes rays_;
  const SupportPlane& plane_;
  Image<RawLabel> labels_;
  Image<float> height_;  ///< above the plane, metres
};

}  // namespace

Image<RawLabel> label_raw(const DepthImage& depth, const Intrinsics& intrinsics, const SupportPlane& plane,
                          const std::function<bool(const Eigen::Vector3d&)>& in_reach,
                          const std::function<bool(const Eigen::Vector3d&)>& behind) {
  return Labeller(depth, intrinsics, plane).run(in_reach, behind);
}

}  // namespace perch
