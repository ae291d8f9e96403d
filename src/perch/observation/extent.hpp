#pragma once

#include <Eigen/Geometry>

#include "perch/observation/observation.hpp"

namespace perch {

/// World height, metres, below which one point of I in 200 lies: objects meet their support plane there, and
/// a few points in a hundred are noise below it.
double lowest_height(const Observation& observation);

/// The smallest rectangle along the world's x and y that holds all of I, metres.
Eigen::AlignedBox2d footprint(const Observation& observation);

}  // namespace perch
