#include "perch/sim/example_scene.hpp"

#include <cmath>

#include "perch/sim/parametric_models.hpp"

namespace perch {

SimulatedScene tabletop_example() {
  constexpr double distance = 0.9, elevation = 0.58;  // metres; radians
  const Eigen::Vector3d middle(0.0, 0.02, 0.07);
  const Eigen::Vector3d towards_camera(0.0, -std::cos(elevation), std::sin(elevation));
  SceneLayout layout;
  layout.name = "tabletop";
  layout.camera =
      camera_looking_at({640, 480, 525, 525, 319.5, 239.5}, middle + distance * towards_camera, middle);
  layout.workspace = {-0.2, 0.2, -0.15, 0.2};
  for (const char* name : {"bottle", "carton", "mug", "tin"}) layout.models.push_back(household_model(name));
  constexpr std::size_t bottle = 0, carton = 1, mug = 2, tin = 3;
  layout.objects = {{bottle, {-0.137, 0.071, 0.0}},
                    {carton, {0.034, 0.052, 0.3}},
                    {mug, {-0.112, -0.062, 2.6}},
                    {mug, {0.121, 0.154, -0.35}},
                    {tin, {0.104, -0.066, 0.2}}};
  constexpr std::uint64_t seed = 20160516;
  return simulate(layout, DepthSensorSettings{}, seed);
}

const std::string& tabletop_example_comment() {
  static const std::string comment =
      "Five household objects on a table, seen by a simulated Kinect from 0.9 m, 33 degrees from above.\n"
      "Made by script/make_example; the meshes are computed from a few dimensions each.";
  return comment;
}

}  // namespace perch
