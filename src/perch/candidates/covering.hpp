#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perch/candidates/candidate.hpp"

namespace perch {

/// What is left of the explanation cost when occlusion among the candidates is known only by pixel: choose
/// for each slot as many options as it has copies. A point costs 1 unless an option chosen explains it. A
/// pixel costs 1 if an option chosen is certain to leave it unexplained, or if one leaves it unexplained and
/// no other one relieves it, by showing an explained point there. No scene made of these options costs less.
struct Covering {
  struct Option {
    std::uint32_t slot = 0;
    std::vector<Run> explained;  ///< points
    std::vector<Run> certain;    ///< pixels
    std::vector<Run> uncertain;  ///< pixels
    std::vector<Run> relieved;   ///< pixels
  };

  std::size_t points = 0;
  std::size_t pixels = 0;
  std::int64_t fixed = 0;   ///< what every choice costs beyond
  std::vector<int> copies;  ///< of each slot; options of a slot without copies take no part
  std::vector<Option> options;
};

/// Old numbers of what compact() left.
struct CoveringNumbers {
  std::vector<std::uint32_t> points, pixels;
};

/// Forgets points that no option explains and pixels that none leaves unexplained; what is left is numbered
/// anew, in its order.
CoveringNumbers compact(Covering& covering);

}  // namespace perch
