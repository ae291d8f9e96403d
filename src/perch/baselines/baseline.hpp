#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perch/core/pose.hpp"

namespace perch {

/// What a method without a bound says of a scene.
struct BaselineAnswer {
  std::vector<std::optional<Pose>> poses;  ///< of Scene::objects, in their order; empty where none was found
  std::int64_t hypotheses = 0;             ///< poses valued
  bool stopped = false;                    ///< the clock struck first; `poses` is the best until then
};

}  // namespace perch
