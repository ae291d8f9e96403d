#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/core/random.hpp"
#include "perch/cost/cost_settings.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// An observation and patches near it, all at random; delta from less than a pixel to several.
struct RandomScene {
  Camera camera;
  DepthImage depth;
  std::optional<Image<std::uint8_t>> mask;
  std::vector<DepthPatch> patches;
  double delta;
};

inline DepthPatch random_patch(Random& random, const Intrinsics& k, double near, double spread,
                               double holes) {
  const int u0 = static_cast<int>(random.below(static_cast<std::uint64_t>(k.width)));
  const int v0 = static_cast<int>(random.below(static_cast<std::uint64_t>(k.height)));
  const int u1 = u0 + 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(k.width - u0)));
  const int v1 = v0 + 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(k.height - v0)));
  DepthPatch patch{{u0, v0, u1, v1}, {}};
  const double slope_u = random.uniform(-0.01, 0.01), slope_v = random.uniform(-0.01, 0.01);
  for (int v = v0; v < v1; ++v)
    for (int u = u0; u < u1; ++u)
      patch.depth.push_back(random.uniform() < holes
                                ? no_surface
                                : static_cast<float>(near + slope_u * (u - u0) + slope_v * (v - v0) +
                                                     random.uniform(0, spread)));
  for (float& z : patch.depth) z = std::max(z, 0.05F);
  return patch;
}

/// \param size the image is at most 30 by 24 times as large.
inline RandomScene random_scene(std::uint64_t seed, int size = 1) {
  Random random(seed);
  RandomScene scene;
  const int width = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(30 * size))),
            height = 1 + static_cast<int>(random.below(static_cast<std::uint64_t>(24 * size)));
  const double f = random.uniform(8, 120);
  scene.camera.intrinsics = {
      width, height, f, f * random.uniform(0.9, 1.1), width * random.uniform(-0.2, 1.2), height * 0.45};
  const double near = random.uniform(0.2, 1.5),
               spread = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 0.2);
  scene.delta = random.uniform(0.2, 3.0) * near / f;  // from less than a pixel to several
  scene.depth = DepthImage(width, height);
  for (std::size_t i = 0; i < scene.depth.size(); ++i)
    if (random.uniform() < 0.7) scene.depth[i] = static_cast<float>(near + random.uniform(0, spread));
  if (scene.depth.data() == std::vector<float>(scene.depth.size(), 0.0F))
    scene.depth[0] = static_cast<float>(near);
  if (random.uniform() < 0.5) {
    scene.mask = Image<std::uint8_t>(width, height);
    bool any = false;
    for (std::size_t i = 0; i < scene.depth.size(); ++i) {
      (*scene.mask)[i] = random.uniform() < 0.7;
      any = any || ((*scene.mask)[i] && scene.depth[i] > 0);
    }
    if (!any) scene.mask.reset();
  }
  const std::size_t n = 1 + random.below(4);
  for (std::size_t i = 0; i < n; ++i)
    scene.patches.push_back(random_patch(random, scene.camera.intrinsics,
                                         near + random.uniform(-1, 1) * scene.delta * 2,
                                         spread * random.uniform(), random.uniform(0, 0.5)));
  return scene;
}

/// The ways in which costs can be counted.
inline std::vector<CostSettings> cost_variants(double delta) {
  std::vector<CostSettings> variants{{delta}, {delta, MissingDepth::ignore}};
  variants.push_back({delta, MissingDepth::unexplained, true, 0.2, ClutterPoints::ignore});
  variants.push_back({delta, MissingDepth::ignore, true, 0.75, ClutterPoints::charge});
  return variants;
}

}  // namespace perch
