#pragma once

#include <cstddef>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/localize/scene.hpp"

namespace perch::app {

/// How light the surface seen at each pixel of a window of a depth image is, 0 to 1: lit from above the
/// camera's left shoulder, from normals of neighbouring points. \param depth metres, 0 = nothing; its pixels
/// without depth have no meaning in what is returned. \param smoothing pixels around each whose depths are
/// averaged first, within one surface: 0 for a noiseless image.
Image<float> shading(const DepthImage& depth, const Intrinsics& intrinsics, const Window& window,
                     int smoothing);

/// A range of depth, metres.
struct DepthRange {
  float near = 0.0F, far = 1.0F;

  /// 0 at `near` and nearer, 1 at `far` and farther.
  float place(float depth) const;
};

/// From the 1st to the 99th hundredth of the depths; metres. \param depths may be empty.
DepthRange depth_range(std::vector<float> depths);

/// Perceptually even from near (yellow) over green and blue to far (violet), for t from 0 to 1; the colours
/// of viridis, which the colour-blind can tell apart.
Rgb depth_color(float t);

/// A colour for each object, neighbours in number well apart also for the colour-blind (after Okabe and Ito);
/// repeated lighter and darker after eight.
Rgb object_color(std::size_t object);

Rgb scaled(Rgb color, float factor);
Rgb mixed(Rgb a, Rgb b, float share_of_b);

}  // namespace perch::app
