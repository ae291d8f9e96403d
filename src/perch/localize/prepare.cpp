#include "perch/localize/prepare.hpp"

#include "perch/localize/localize.hpp"
#include "perch/localize/reach.hpp"

namespace perch {

namespace {

constexpr double sensor_noise = 0.02;  // metres; a reading of an object is seldom farther off

}  // namespace

Scene prepare(Scene scene, const Settings&, const Executor&) {
  // What no object reaches is no object's. It may still hide one.
  if (scene.clutter) {
    scene.table_height = table_height(scene);
    scene.mask = readings_in_reach(scene, *scene.table_height, sensor_noise);
  }
  return scene;
}

}  // namespace perch
