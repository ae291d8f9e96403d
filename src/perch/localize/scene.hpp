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
#include "perch/observation/support_plane.hpp"

namespace perch {

/// A model as a scene names it, in one of the orientations in which it may rest on the support plane: a body.
/// A model has one body for each; they stand next to each other, have one name, and each object of the model
/// is one of them.
struct SceneModel {
  std::string name;
  Mesh mesh;                             ///< metres, stood on z = 0
  Symmetry symmetry = Symmetry::none();  ///< of the mesh as it stands
  double base = 0.0;                     ///< height of the lowest point above the support plane, metres
  bool find_symmetry = false;            ///< `symmetry` is still to be found, by prepare()
  int rest_pose = 0;                     ///< which of the model's bodies this is, from 0
  /// Maps the model's own frame (lowest point at z = 0, x and y as in the file) to the one in which `mesh`
  /// stands.
  Eigen::Isometry3d stood_from_model = Eigen::Isometry3d::Identity();
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< what points up, in the model's own frame, unit length
};

/// The first body of the model that a body is of.
inline std::size_t kind_of(const std::vector<SceneModel>& models, std::size_t body) {
  return body - static_cast<std::size_t>(models[body].rest_pose);
}

/// How many bodies the model has that a body is of.
inline std::size_t rest_pose_count(const std::vector<SceneModel>& models, std::size_t body) {
  std::size_t next = kind_of(models, body) + 1;
  while (next < models.size() && models[next].rest_pose > 0) ++next;
  return next - kind_of(models, body);
}

/// The bodies of a model, one for each direction that may point up. What symmetry it has about its own z
/// holds where that stands upright or upside down; lying it is taken to have none. \param upright the model
/// as loaded. \param ups in its frame, unit length.
std::vector<SceneModel> bodies_of(const SceneModel& upright, const std::vector<Eigen::Vector3d>& ups);

/// A model's pose in the scene: of the body that `model` counts into Scene::models.
struct PlacedModel {
  std::size_t model = 0;
  Pose pose;
};

/// An object that the scene holds, or may hold; `model` counts into Scene::models and is the first body of
/// the object's model, whichever of them it turns out to be.
struct SceneObject {
  SceneObject(std::size_t of_model, bool may_be_absent = false) : model(of_model), optional(may_be_absent) {}

  std::size_t model = 0;
  bool optional = false;  ///< may be absent
  friend bool operator==(const SceneObject&, const SceneObject&) = default;
};

/// A ground-truth pose of a body; the symmetry, of the body as it stands, is for scoring only.
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

/// The support plane as it was found in a depth image, and what of the scene was taken from it.
struct EstimatedSupport {
  SupportPlane plane;
  bool camera = false;  ///< the camera's pose
  bool height = false;  ///< the table's height
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
  bool clutter = false;  ///< things may be in view that no model describes: see CostSettings::clutter
  std::optional<Image<Rgb>> color;     ///< for pictures only
  std::optional<double> table_height;  ///< world z of the support plane; estimated if absent
  std::optional<Workspace> workspace;  ///< derived from the observed points if absent
  std::vector<SceneModel> models;      ///< the bodies of each model one after the other
  std::vector<SceneObject> objects;    ///< repeats allowed
  std::vector<PlacedModel> priors;     ///< poses that another detector proposes; they guide the search only
  std::vector<TruthPose> truth;        ///< may be empty
  std::optional<EstimatedSupport> support;  ///< where it was looked for

  /// The first body of the model that a body is of.
  std::size_t kind(std::size_t body) const { return kind_of(models, body); }
};

}  // namespace perch
