#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "perch/candidates/grid.hpp"
#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/core/pose.hpp"
#include "perch/model/mesh.hpp"
#include "perch/model/symmetry.hpp"

namespace perch {

/// A model as a scene names it.
struct SceneModel {
  std::string name;
  Mesh mesh;  ///< metres, stood on z = 0
  Symmetry symmetry = Symmetry::none();
  double base = 0.0;           ///< height of the lowest point above the support plane, metres
  bool find_symmetry = false;  ///< `symmetry` is still to be found, by prepare()
};

/// A model's pose in the scene; `model` counts into Scene::models.
struct PlacedModel {
  std::size_t model = 0;
  Pose pose;
};

/// An object that the scene holds, or may hold; `model` counts into Scene::models.
struct SceneObject {
  SceneObject(std::size_t of_model, bool may_be_absent = false) : model(of_model), optional(may_be_absent) {}

  std::size_t model = 0;
  bool optional = false;  ///< may be absent
  friend bool operator==(const SceneObject&, const SceneObject&) = default;
};

/// A ground-truth pose; the symmetry is for scoring only.
struct TruthPose {
  std::size_t model = 0;
  Pose pose;
  Symmetry symmetry = Symmetry::none();
  bool has_models_symmetry = false;  ///< `symmetry` is its model's, also where that is still to be found
};

/// What of the depth image belongs to no object of interest.
enum class Background {
  removed,  ///< nothing, or what the mask leaves out
  table     ///< the support plane too, and what lies below it or outside the workspace
};

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  friend bool operator==(const Rgb&, const Rgb&) = default;
};

/// Everything that a localization starts from, as read and checked; metres and radians.
struct Scene {
  std::string name;  ///< for messages and folder names
  Camera camera;
  bool has_camera_pose = true;  ///< else `world_from_camera` is to be estimated from the support plane
  DepthImage depth;             ///< metres, 0 = no reading; size as in the intrinsics
  double depth_scale = 0.001;  ///< metres per count of the input image; what rendered_depth.png is written in
  std::optional<Image<std::uint8_t>> mask;  ///< non-zero: the pixel belongs to an object of interest
  Background background = Background::removed;
  std::optional<Image<Rgb>> color;     ///< for pictures only
  std::optional<double> table_height;  ///< world z of the support plane; estimated if absent
  std::optional<Workspace> workspace;  ///< derived from the observed points if absent
  std::vector<SceneModel> models;
  std::vector<SceneObject> objects;  ///< repeats allowed
  std::vector<PlacedModel> priors;   ///< poses that another detector proposes; they guide the search only
  std::vector<TruthPose> truth;      ///< may be empty
};

}  // namespace perch
