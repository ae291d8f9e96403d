#pragma once

#include <string>

#include "perch/sim/simulated_scene.hpp"

namespace perch {

/// The scene that comes with the program, in examples/tabletop: a bottle, a carton, two mugs and a tin on a
/// table as a Kinect-like camera sees them from 0.9 m. One mug stands half behind the carton.
SimulatedScene tabletop_example();

/// What the head of its scene file says.
const std::string& tabletop_example_comment();

}  // namespace perch
