#include "perch/cost/counted_depths.hpp"

#include <cmath>
#include <limits>

namespace perch {

bool charged_by_clutter(int u, int v, double weight) {
  // The rank of a pixel in Bayer's pattern: the bits of v and of u xor v, interleaved from the lowest up.
  const int a = v & 7, b = (u ^ v) & 7;
  int rank = 0;
  for (int bit = 0; bit < 3; ++bit) rank = 4 * rank + 2 * ((b >> bit) & 1) + ((a >> bit) & 1);
  return rank < static_cast<int>(std::lround(64.0 * weight));
}

CountedDepths::CountedDepths(const Observation& observation, const CostSettings& settings) {
  const bool ignores = settings.missing_depth == MissingDepth::ignore;
  if (!ignores && !settings.clutter) return;
  constexpr float any = std::numeric_limits<float>::infinity();
  const Intrinsics& k = observation.intrinsics();
  farthest_ = Image<float>(k.width, k.height, any);
  const auto delta = static_cast<float>(settings.delta);
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const float reading = observation.reading(u, v);
      if (ignores && observation.state(u, v) == PixelState::unknown)
        farthest_(u, v) = -any;
      else if (settings.clutter && reading > 0.0F && !charged_by_clutter(u, v, settings.clutter_weight))
        farthest_(u, v) = reading + delta;
    }
}

}  // namespace perch
