#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/localize/scene.hpp"
#include "perch/sim/depth_sensor.hpp"

namespace perch {

/// A scene with its truth, and how much of each object the camera sees.
struct SimulatedScene {
  Scene scene;
  /// For each of scene.objects: pixels at which it is the nearest, of those that it would cover alone.
  std::vector<double> visible_fractions;
};

/// A scene before anyone looks at it.
struct SceneLayout {
  std::string name;
  Camera camera;
  std::vector<SceneModel> models;    ///< as Scene::models: bodies
  std::vector<PlacedModel> objects;  ///< on the support plane z = 0
  Workspace workspace;
};

/// What an ideal camera sees of a layout.
struct RenderedLayout {
  DepthImage depth;                       ///< metres, 0 where no object is
  std::vector<double> visible_fractions;  ///< as in SimulatedScene
  std::vector<Window> windows;            ///< the image of each object alone, cut to the image
  std::vector<std::int64_t> visible;      ///< pixels at which each object is the nearest
  std::vector<std::int64_t> alone;        ///< pixels that each would cover alone
  Image<std::uint16_t> objects;           ///< at each pixel 1 + the nearest object, 0 where there is none
};

RenderedLayout render_layout(const SceneLayout& layout);

/// True for the window of something that is in view and touches no border of the image.
bool clear_of_border(const Window& window, const Intrinsics& intrinsics);

/// The layout with its truth, and no depth image yet.
Scene unobserved_scene(const SceneLayout& layout);

/// The layout as the sensor sees it, background removed, with all of its truth.
SimulatedScene simulate(const SceneLayout& layout, const DepthSensorSettings& sensor, std::uint64_t seed);

/// A camera at `eye` whose optical axis runs through `target` (world metres, not one above the other), its
/// image upright.
Camera camera_looking_at(const Intrinsics& intrinsics, const Eigen::Vector3d& eye,
                         const Eigen::Vector3d& target);

}  // namespace perch
