#include "perch/io/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <new>

#include "perch/core/error.hpp"
#include "perch/io/cloud_depth_file.hpp"
#include "perch/io/mesh_file.hpp"
#include "perch/io/message.hpp"
#include "perch/io/model_names.hpp"
#include "perch/io/png.hpp"
#include "perch/io/yaml_entry.hpp"
#include "perch/model/rest_poses.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

/// Runs `read` and puts file and key before what it throws.
template <typename Read>
auto at_key(const YamlEntry& entry, const Read& read) {
  try {
    return read();
  } catch (const InputError& e) {
    entry.fail(e.what());
  }
}

fs::path beside(const fs::path& folder, const YamlEntry& entry) {
  return (folder / entry.text()).lexically_normal();
}

Intrinsics read_intrinsics(const YamlEntry& entry) {
  const YamlFields fields = entry.fields({"width", "height", "fx", "fy", "cx", "cy"});
  const auto pixels = [&](const char* key) {
    return fields.required(key, "give it in pixels").number("pixels");
  };
  const auto size = [&](const char* key) {
    return fields.required(key, "give it in pixels").integer(1, 16384);
  };
  const Intrinsics intrinsics{size("width"), size("height"), pixels("fx"),
                              pixels("fy"),  pixels("cx"),   pixels("cy")};
  at_key(entry, [&] { intrinsics.check(); });
  return intrinsics;
}

Eigen::Isometry3d read_transform(const YamlEntry& entry) {
  const auto rows = entry.items("4 rows of 4 numbers");
  if (rows.size() != 4) entry.fail(fmt::format("has {} rows; give a 4 x 4 matrix", rows.size()));
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 4; ++i) {
    const auto values = rows[static_cast<std::size_t>(i)].items("4 numbers");
    if (values.size() != 4)
      rows[static_cast<std::size_t>(i)].fail(
          fmt::format("has {} values; give a 4 x 4 matrix", values.size()));
    for (int j = 0; j < 4; ++j)
      matrix(i, j) =
          values[static_cast<std::size_t>(j)].number(j == 3 && i < 3 ? "metres" : "a matrix entry");
  }
  try {
    return rigid_transform(matrix, "the matrix");
  } catch (const InputError& e) {
    entry.fail(fmt::format("{}; give the camera's pose in the world, metres, z up", e.what()));
  }
}

Camera read_camera(const YamlEntry& entry, bool& pose_given) {
  const YamlFields fields = entry.fields({"intrinsics", "world_from_camera"});
  Camera camera;
  camera.intrinsics =
      read_intrinsics(fields.required("intrinsics", "give width, height, fx, fy, cx and cy in pixels"));
  pose_given = false;
  if (const YamlEntry* pose = fields.optional("world_from_camera")) {
    camera.world_from_camera = read_transform(*pose);
    pose_given = true;
  }
  return camera;
}

LengthUnit read_unit(const YamlEntry& word) {
  const auto parsed = parse_length_unit(word.text());
  if (!parsed) word.fail(fmt::format("{} is no unit; give m or mm", word.value()));
  return *parsed;
}

CloudReading read_cloud_reading(const YamlFields& fields, bool has_camera_pose) {
  CloudReading reading;
  if (const YamlEntry* unit = fields.optional("cloud_unit")) reading.unit = read_unit(*unit);
  if (const YamlEntry* frame = fields.optional("cloud_frame")) {
    const std::string word = frame->text();
    if (word != "camera" && word != "world")
      frame->fail(fmt::format("{} is no frame; give camera or world", frame->value()));
    if (word == "world") reading.frame = CloudFrame::world;
    if (word == "world" && !has_camera_pose)
      frame->fail("\"world\" needs the camera's pose; give camera.world_from_camera");
  }
  return reading;
}

void read_observation(const YamlEntry& entry, const fs::path& folder, Scene& scene) {
  const YamlFields fields = entry.fields({"depth", "depth_scale", "mask", "cloud", "cloud_frame",
                                          "cloud_unit", "color", "background", "clutter"});
  if (const YamlEntry* background = fields.optional("background")) {
    const std::string word = background->text();
    if (word == "table")
      scene.background = Background::table;
    else if (word != "removed")
      background->fail(fmt::format("{} is no background; {}", background->value(),
                                   did_you_mean(word, {"removed", "table"})));
  }
  if (const YamlEntry* clutter = fields.optional("clutter")) scene.clutter = clutter->boolean();
  const YamlEntry* cloud = fields.optional("cloud");
  if (!cloud) fields.required("depth_scale", "give the metres per count, e.g. 0.001");
  if (const YamlEntry* scale = fields.optional("depth_scale")) {
    scene.depth_scale = scale->number("metres per count");
    if (scene.depth_scale <= 0.0)
      scale->fail(fmt::format("{} is not > 0; give the metres per count, e.g. 0.001", scale->value()));
  }

  const int width = scene.camera.intrinsics.width, height = scene.camera.intrinsics.height;
  if (cloud) {
    if (const YamlEntry* depth = fields.optional("depth"))
      depth->fail("stands beside observation.cloud; give one of the two");
    const CloudReading reading = read_cloud_reading(fields, scene.has_camera_pose);
    scene.depth = at_key(*cloud, [&] {
      return read_cloud_depth(beside(folder, *cloud), reading, scene.camera, scene.has_camera_pose);
    });
  } else {
    for (const char* key : {"cloud_frame", "cloud_unit"})
      if (const YamlEntry* of_cloud = fields.optional(key))
        of_cloud->fail("there is no observation.cloud; remove it, or name a PCD or PLY file there");
    const YamlEntry& depth = fields.required("depth", "name a 16-bit greyscale PNG");
    scene.depth = depth_from_counts(
        at_key(depth, [&] { return read_png16_gray(beside(folder, depth), width, height); }),
        scene.depth_scale);
  }
  if (const YamlEntry* mask = fields.optional("mask"))
    scene.mask = at_key(*mask, [&] { return read_mask(beside(folder, *mask), width, height); });
  if (const YamlEntry* color = fields.optional("color"))
    scene.color = at_key(*color, [&] { return read_color(beside(folder, *color), width, height); });
}

double read_table(const YamlEntry& entry) {
  return entry.fields({"height"})
      .required("height", "give the support plane's height in the world, metres")
      .number("metres");
}

Workspace read_workspace(const YamlEntry& entry) {
  const YamlFields fields = entry.fields({"x", "y"});
  const auto range = [&](const char* key) {
    const YamlEntry& side = fields.required(key, "give [min, max] in metres");
    const auto ends = side.items("two numbers, [min, max] in metres");
    if (ends.size() != 2) side.fail(fmt::format("has {} values; give [min, max] in metres", ends.size()));
    const std::pair<double, double> out{ends[0].number("metres"), ends[1].number("metres")};
    if (out.first >= out.second)
      side.fail(fmt::format("[{}, {}] is empty; give [min, max] with min < max", out.first, out.second));
    return out;
  };
  const auto [x_min, x_max] = range("x");
  const auto [y_min, y_max] = range("y");
  return {x_min, x_max, y_min, y_max};
}

Symmetry read_symmetry(const YamlEntry& entry) {
  const std::string word = entry.text();
  if (word == "none") return Symmetry::none();
  if (word == "continuous") return Symmetry::continuous();
  const bool number = word.find_first_not_of("+-0123456789.eE") == std::string::npos;
  if (number && !entry.is_quoted()) return Symmetry::n_fold(entry.integer(1, 360));
  entry.fail(fmt::format(
      "{} is no symmetry; give none, continuous, a whole number from 1 to 360 or, for a model, auto",
      entry.value()));
}

/// Reads each file once, however many models share it.
class MeshShelf {
 public:
  const Mesh& get(const fs::path& path, LengthUnit unit, const std::string& unit_key) {
    const auto key = std::pair(path, unit);
    const auto found = meshes_.find(key);
    if (found != meshes_.end()) return found->second;
    return meshes_.emplace(key, stood_on_ground(read_mesh(path, unit, unit_key))).first->second;
  }

 private:
  std::map<std::pair<fs::path, LengthUnit>, Mesh> meshes_;
};

/// The directions that point up when the model rests by itself.
std::vector<Eigen::Vector3d> stable_ups(const YamlEntry& entry, const SceneModel& model) {
  std::vector<Eigen::Vector3d> ups;
  try {
    for (const StablePose& pose : rest_poses(model.mesh, ModelSymmetries::about_z(model.symmetry)))
      ups.push_back(pose.up);
  } catch (const InputError& e) {
    entry.fail(
        fmt::format("\"auto\": the mesh {}; list the directions that may point up, as [0, 0, 1]", e.what()));
  }
  return ups;
}

/// The directions of the model's frame that may point up, unit length.
std::vector<Eigen::Vector3d> read_rest_poses(const YamlEntry& entry, const SceneModel& model) {
  constexpr std::size_t most = 64;
  constexpr double least_angle = 1e-4;  // radians: two that differ by less are one
  if (entry.is_scalar() && entry.text() == "auto") return stable_ups(entry, model);
  const auto items = entry.items("directions of the model that may point up");
  if (items.empty()) entry.fail("is empty; list the directions of the model that may point up, as [0, 0, 1]");
  if (items.size() > most) entry.fail(fmt::format("has {} entries; give at most {}", items.size(), most));
  std::vector<Eigen::Vector3d> ups;
  for (const YamlEntry& item : items) {
    const auto numbers = item.items("three numbers");
    if (numbers.size() != 3)
      item.fail(fmt::format("has {} values; give a direction as [x, y, z]", numbers.size()));
    Eigen::Vector3d up;
    for (int i = 0; i < 3; ++i) up[i] = numbers[static_cast<std::size_t>(i)].number("a part of a direction");
    const double longest = up.cwiseAbs().maxCoeff();
    if (!(longest > 0.0)) item.fail("has no direction; give one that is not [0, 0, 0]");
    up = (up / longest).normalized();  // scaled first: squares may not fit
    for (std::size_t i = 0; i < ups.size(); ++i)
      if ((ups[i] - up).norm() < least_angle)
        item.fail(fmt::format("is the direction of entry {} again; give each once", i));
    ups.push_back(up);
  }
  return ups;
}

std::vector<SceneModel> read_model(const std::string& name, const YamlEntry& entry, const fs::path& folder,
                                   MeshShelf& shelf) {
  constexpr double farthest_base = 5.0;
  if (name.empty()) entry.fail("a model has no name; name it");
  const YamlFields fields = entry.fields({"mesh", "unit", "symmetry", "base", "rest_poses"});
  SceneModel model;
  model.name = name;
  LengthUnit unit = LengthUnit::metres;
  if (const YamlEntry* word = fields.optional("unit")) unit = read_unit(*word);
  if (const YamlEntry* symmetry = fields.optional("symmetry")) {
    model.find_symmetry = !symmetry->is_quoted() && symmetry->text() == "auto";
    if (!model.find_symmetry) model.symmetry = read_symmetry(*symmetry);
  }
  if (const YamlEntry* base = fields.optional("base")) {
    model.base = base->number("metres above the support plane");
    if (std::abs(model.base) > farthest_base)
      base->fail(
          fmt::format("{} m is beyond {} m from the support plane; give the height of the model's lowest "
                      "point in metres",
                      model.base, farthest_base));
  }
  const YamlEntry& mesh = fields.required("mesh", "name a mesh file");
  model.mesh = at_key(mesh, [&] { return shelf.get(beside(folder, mesh), unit, entry.key() + ".unit"); });
  std::vector<Eigen::Vector3d> ups{Eigen::Vector3d::UnitZ()};
  if (const YamlEntry* given = fields.optional("rest_poses")) ups = read_rest_poses(*given, model);
  return bodies_of(model, ups);
}

std::vector<SceneModel> read_models(const YamlEntry& entry, const fs::path& folder) {
  std::vector<SceneModel> models;
  MeshShelf shelf;
  for (const auto& [name, model] : entry.pairs())
    for (SceneModel& body : read_model(name, model, folder, shelf)) models.push_back(std::move(body));
  if (models.empty()) entry.fail("holds no model; give at least one");
  return models;
}

/// A model's name, or {model: NAME, optional: true}.
SceneObject read_object(const YamlEntry& item, const std::vector<SceneModel>& models) {
  if (!item.is_map()) return model_index(item, models);
  const YamlFields fields = item.fields({"model", "optional"});
  const YamlEntry& model = fields.required("model", "name a model");
  const YamlEntry* optional = fields.optional("optional");
  return {model_index(model, models), optional != nullptr && optional->boolean()};
}

std::vector<SceneObject> read_objects(const YamlEntry& entry, const std::vector<SceneModel>& models) {
  constexpr std::size_t most = 1000;
  const auto items = entry.items("model names");
  if (items.empty()) entry.fail("is empty; name at least one model");
  if (items.size() > most) entry.fail(fmt::format("has {} entries; give at most {}", items.size(), most));
  std::vector<SceneObject> objects;
  for (const YamlEntry& item : items) objects.push_back(read_object(item, models));
  return objects;
}

std::vector<TruthPose> read_truth(const YamlEntry& entry, const std::vector<SceneModel>& models) {
  std::vector<TruthPose> truth;
  for (const YamlEntry& item : entry.items("{model, x, y, yaw}")) {
    std::vector<std::string> keys = placed_model_keys;
    keys.push_back("symmetry");
    const YamlFields fields = item.fields(keys);
    const PlacedModel placed = placed_model(fields, models);
    const YamlEntry* symmetry = fields.optional("symmetry");
    truth.push_back({placed.model, placed.pose,
                     symmetry ? read_symmetry(*symmetry) : models[placed.model].symmetry, !symmetry});
  }
  return truth;
}

Scene read_checked(const fs::path& scene_file) {
  const YamlEntry root = YamlEntry::read(scene_file);
  const YamlFields fields = root.fields(
      {"version", "camera", "observation", "table", "workspace", "models", "objects", "priors", "truth"});
  const YamlEntry& version = fields.required("version", "give version: 1");
  if (version.is_quoted() || version.text() != "1")
    version.fail(fmt::format("{} is not a version that can be read; give version: 1", version.value()));

  const fs::path folder = scene_file.parent_path();
  Scene scene;
  scene.name = scene_file.stem().string();
  const YamlEntry& camera = fields.required("camera", "give intrinsics and world_from_camera");
  scene.camera = read_camera(camera, scene.has_camera_pose);
  const YamlEntry& observation = fields.required("observation", "give depth and depth_scale, or cloud");
  const YamlEntry& models = fields.required("models", "give name: {mesh: FILE}");
  const YamlEntry& objects = fields.required("objects", "list the names of the models present");
  if (const YamlEntry* table = fields.optional("table")) scene.table_height = read_table(*table);
  if (const YamlEntry* workspace = fields.optional("workspace")) scene.workspace = read_workspace(*workspace);
  read_observation(observation, folder, scene);
  if (!scene.has_camera_pose && scene.background == Background::removed)
    camera.fail_at(
        "world_from_camera",
        "is missing; give the camera's pose in the world, or leave the table in the depth image and set "
        "observation.background: table");
  scene.models = read_models(models, folder);
  scene.objects = read_objects(objects, scene.models);
  if (const YamlEntry* priors = fields.optional("priors"))
    for (const YamlEntry& item : priors->items("{model, x, y, yaw}"))
      scene.priors.push_back(placed_model(item.fields(placed_model_keys), scene.models));
  if (const YamlEntry* truth = fields.optional("truth")) scene.truth = read_truth(*truth, scene.models);
  return scene;
}

}  // namespace

Scene read_scene(const fs::path& scene_file) {
  try {
    return read_checked(scene_file);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format("{}: there is not enough memory to read it; use smaller images or meshes",
                                 shown(scene_file)));
  } catch (const std::exception& e) {
    throw InputError(
        fmt::format("{}: can't be read ({}); check the file", shown(scene_file), one_line(e.what())));
  }
}

}  // namespace perch
