#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "perch/core/stop.hpp"

namespace perch {

/// Objects that are placed one after the other: each at the pose of its model that fits best among those
/// that collide with nothing placed before.
struct GreedyPlacing {
  std::vector<std::vector<std::int64_t>> misfits;  ///< of each model, of each of its poses; ascending, >= 0
  std::vector<std::size_t> objects;                ///< the model of each object
  /// Whether pose i of model a and pose j of model b collide. A pose always collides with itself.
  std::function<bool(std::size_t a, std::size_t i, std::size_t b, std::size_t j)> collide;
};

/// Where the best of all orders puts the objects.
struct BestOrder {
  std::vector<std::optional<std::size_t>> poses;  ///< of each object, into its model's; copies ascending
  bool complete = true;                           ///< false where the clock struck: the best order until then
};

/// Of all K! orders one that leaves the fewest objects without a pose and, of these, has the least sum of
/// misfits. The answer is that of trying them all: the copies of a model are alike, orders that have placed
/// the same poses go on alike, and an order is given up only where even the best free pose of each object
/// left, as if these did not collide, makes it no better than one already known.
BestOrder best_order(const GreedyPlacing& placing, const StopCondition& stop);

}  // namespace perch
