#include "perch/io/bop_dataset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/core/pose.hpp"
#include "perch/io/bop_json.hpp"
#include "perch/io/message.hpp"
#include "perch/io/png.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_objects = 1000;
constexpr int axis_steps = 72;  // of a turn about an axis of symmetry

/// The folders within a folder, for messages.
std::vector<std::string> folders_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (std::error_code ignored; it->is_directory(ignored)) names.push_back(it->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// \param within whose folders the message names, unless they are very many.
void require_folder(const fs::path& folder, const fs::path& within, const std::string& remedy) {
  constexpr std::size_t most_named = 20;
  std::error_code ignored;
  if (fs::is_directory(folder, ignored)) return;
  const std::vector<std::string> known = folders_in(within);
  if (known.size() > most_named)
    throw InputError(fmt::format("{}: no such folder; {} there are {}, from {} to {}", shown(folder), remedy,
                                 known.size(), one_line(known.front()), one_line(known.back())));
  throw InputError(fmt::format("{}: no such folder; {} {}", shown(folder), remedy,
                               did_you_mean(folder.filename().string(), known)));
}

fs::path models_folder(const fs::path& folder, const std::string& named) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    throw InputError(fmt::format("{}: no such folder; give that of a data set in BOP layout", shown(folder)));
  if (named.empty())
    for (const char* name : {"models", "models_eval", "models_cad"})
      if (fs::is_directory(folder / name, ignored)) return folder / name;
  const fs::path models = folder / (named.empty() ? "models" : named);
  require_folder(models, folder, "give that of the models with --models;");
  return models;
}

/// The last part of a path, also of one that ends in a slash or a dot.
std::string name_of(const fs::path& folder) {
  std::error_code ignored;
  fs::path whole = fs::weakly_canonical(folder, ignored);
  if (!whole.has_filename()) whole = whole.parent_path();
  const std::string name = whole.filename().string();
  return name.empty() ? "dataset" : name;
}

Intrinsics read_intrinsics(const JsonEntry& cam_k, const PngSize& size) {
  constexpr double skew = 1e-3;  // pixels
  const std::vector<double> k = cam_k.numbers(9);
  if (std::abs(k[1]) > skew || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0)
    cam_k.fail("is no camera without skew; give [fx, 0, cx, 0, fy, cy, 0, 0, 1] in pixels");
  const Intrinsics intrinsics{size.width, size.height, k[0], k[4], k[2], k[5]};
  try {
    intrinsics.check();
  } catch (const InputError& e) {
    cam_k.fail(e.what());
  }
  return intrinsics;
}

/// Metres per count. Throws where the readings are nowhere near what a depth camera sees.
double read_depth_scale(const JsonEntry& entry, const Image<std::uint16_t>& counts) {
  constexpr double nearest = 0.05, farthest = 100.0;  // metres
  const double scale = 0.001 * entry.number();
  if (!(scale > 0.0))
    entry.fail(fmt::format("{} is not > 0; give millimetres per count, e.g. 0.1", entry.value()));
  const auto most = std::max_element(counts.data().begin(), counts.data().end());
  const double reach = most == counts.data().end() ? 0.0 : scale * *most;
  if (reach == 0.0 || (reach >= nearest && reach <= farthest)) return scale;
  entry.fail(fmt::format("{} puts the farthest reading at {:.4g} m; give millimetres per count, e.g. 0.1",
                         entry.value(), reach));
}

Eigen::Isometry3d read_world_from_camera(const JsonEntry& camera) {
  if (!camera.contains("cam_R_w2c") || !camera.contains("cam_t_w2c"))
    camera.fail(
        "has no cam_R_w2c and cam_t_w2c; leave out --camera-pose, so that the camera's pose is found from "
        "the "
        "support plane");
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  camera_from_world.linear() = bop_rotation(camera["cam_R_w2c"]);
  camera_from_world.translation() = bop_lengths(camera["cam_t_w2c"]);
  return camera_from_world.inverse();
}

Eigen::Isometry3d read_annotated_pose(const JsonEntry& entry) {
  constexpr double nearest = 0.01;  // metres: no depth camera sees what is nearer
  Eigen::Isometry3d camera_from_model = Eigen::Isometry3d::Identity();
  camera_from_model.linear() = bop_rotation(entry["cam_R_m2c"]);
  camera_from_model.translation() = bop_lengths(entry["cam_t_m2c"]);
  if (camera_from_model.translation().norm() < nearest)
    entry["cam_t_m2c"].fail(
        fmt::format("is {:.4g} mm from the camera: metres taken for millimetres? give millimetres",
                    1000.0 * camera_from_model.translation().norm()));
  return camera_from_model;
}

}  // namespace

/// What describes the images of a scene.
struct BopDataset::SceneFiles {
  int scene_id;
  fs::path folder;
  JsonEntry camera;
  std::optional<JsonEntry> truth;

  SceneFiles(int id, const fs::path& of, std::optional<JsonEntry> annotated)
      : scene_id(id),
        folder(of),
        camera(read_bop_json(of / "scene_camera.json")),
        truth(std::move(annotated)) {}

  /// The annotations of an image, of which there may be none.
  std::vector<JsonEntry> annotations(int im_id) const {
    const std::string key = std::to_string(im_id);
    if (!truth || !truth->contains(key)) return {};
    return (*truth)[key].items();
  }
};

BopDataset::BopDataset(const fs::path& folder, const BopOptions& options)
    : folder_(folder),
      name_(name_of(folder)),
      options_(options),
      models_(models_folder(folder, options.models), options.upright) {
  require_folder(folder / options.split, folder, "give one with --split;");
}

BopDataset::~BopDataset() = default;

const BopDataset::SceneFiles& BopDataset::scene_files(int scene_id) {
  if (open_ && open_->scene_id == scene_id) return *open_;
  const fs::path split = folder_ / options_.split, folder = split / six_digits(scene_id);
  require_folder(folder, split, "give a scene of this split;");
  std::optional<JsonEntry> truth;
  std::error_code ignored;
  if (fs::exists(folder / "scene_gt.json", ignored)) truth = read_bop_json(folder / "scene_gt.json");
  open_ = std::make_unique<const SceneFiles>(scene_id, folder, std::move(truth));
  return *open_;
}

BopImageTargets BopDataset::annotated_objects(int scene_id, int im_id) {
  const SceneFiles& files = scene_files(scene_id);
  if (!files.truth)
    throw InputError(fmt::format("{}: no such file; say which objects are in the image with --targets",
                                 shown(files.folder / "scene_gt.json")));
  if (!files.camera.contains(std::to_string(im_id)))
    files.camera.fail(
        fmt::format("has no image {}; give one of its {} images", im_id, files.camera.keys().size()));
  std::map<int, int> count;
  for (const JsonEntry& entry : files.annotations(im_id)) ++count[bop_number(entry["obj_id"])];
  if (count.empty())
    files.truth->fail(
        fmt::format("annotates nothing in image {}; say which objects are in it with --targets", im_id));
  return {scene_id, im_id, {count.begin(), count.end()}};
}

void BopDataset::read_masks(const BopImageTargets& targets, const SceneFiles& files, Scene& scene) const {
  const Intrinsics& size = scene.camera.intrinsics;
  const std::vector<JsonEntry> annotated = files.annotations(targets.im_id);
  bool any = false;
  for (std::size_t i = 0; i < annotated.size(); ++i) {
    const int obj_id = bop_number(annotated[i]["obj_id"]);
    const auto is_target = [&](const auto& object) { return object.first == obj_id; };
    if (std::none_of(targets.objects.begin(), targets.objects.end(), is_target)) continue;
    const std::string name = six_digits(targets.im_id) + "_" + six_digits(static_cast<int>(i)) + ".png";
    const auto mask = read_mask(files.folder / "mask_visib" / name, size.width, size.height);
    if (!scene.mask) scene.mask.emplace(size.width, size.height);
    for (std::size_t p = 0; p < mask.size(); ++p)
      if (mask[p] != 0) (*scene.mask)[p] = 255;
    any = true;
  }
  if (!any)
    throw InputError(
        fmt::format("{}: annotates none of the objects looked for in image {}; leave out --masks",
                    shown(files.folder / "scene_gt.json"), targets.im_id));
}

BopImage BopDataset::image(const BopImageTargets& targets) {
  const SceneFiles& files = scene_files(targets.scene_id);
  const std::string key = std::to_string(targets.im_id), name = six_digits(targets.im_id) + ".png";
  if (!files.camera.contains(key))
    files.camera.fail(
        fmt::format("has no image {}; give one of its {} images", targets.im_id, files.camera.keys().size()));
  const JsonEntry camera = files.camera[key];

  BopImage image;
  image.scene_id = targets.scene_id;
  image.im_id = targets.im_id;
  Scene& scene = image.scene;
  scene.name = six_digits(targets.scene_id) + "_" + six_digits(targets.im_id);
  const fs::path depth = files.folder / "depth" / name;
  scene.camera.intrinsics = read_intrinsics(camera["cam_K"], png_size(depth));
  const Intrinsics& size = scene.camera.intrinsics;
  const Image<std::uint16_t> counts = read_png16_gray(depth, size.width, size.height);
  scene.depth_scale = read_depth_scale(camera["depth_scale"], counts);
  scene.depth = depth_from_counts(counts, scene.depth_scale);
  scene.background = Background::table;
  scene.has_camera_pose = options_.camera_pose;
  if (options_.camera_pose) scene.camera.world_from_camera = read_world_from_camera(camera);
  const fs::path color = files.folder / "rgb" / name;
  if (std::error_code ignored; fs::exists(color, ignored))
    scene.color = read_color(color, size.width, size.height);
  if (options_.masks) read_masks(targets, files, scene);

  std::map<int, std::size_t> first;  // body of each model
  for (const auto& [obj_id, count] : targets.objects) {
    const BopModel& model = models_.get(obj_id);
    first[obj_id] = scene.models.size();
    for (const SceneModel& body : model.bodies) {
      scene.models.push_back(body);
      image.obj_ids.push_back(obj_id);
    }
    for (int i = 0; i < count; ++i) scene.objects.emplace_back(first[obj_id]);
  }
  if (scene.objects.size() > most_objects)
    throw InputError(fmt::format("{}: image {} has {} objects to be found; give at most {}",
                                 shown(files.folder), targets.im_id, scene.objects.size(), most_objects));
  for (const JsonEntry& entry : files.annotations(targets.im_id))
    if (const auto found = first.find(bop_number(entry["obj_id"])); found != first.end())
      image.truth.push_back({found->first, found->second, read_annotated_pose(entry)});
  return image;
}

std::vector<BopTruthResidual> set_bop_truth(BopDataset& dataset, const std::vector<BopTruth>& truth,
                                            Scene& scene) {
  std::vector<BopTruthResidual> residuals;
  scene.truth.clear();
  for (const BopTruth& annotated : truth) {
    const Eigen::Isometry3d world_from_model = scene.camera.world_from_camera * annotated.camera_from_model;
    const BopModel& model = dataset.model(annotated.obj_id);
    double least = std::numeric_limits<double>::infinity();
    std::size_t nearest = 0;
    Eigen::Isometry3d world_from_body = Eigen::Isometry3d::Identity();
    for (const Eigen::Isometry3d& motion : model.symmetries.motions(axis_steps))
      for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        const Eigen::Isometry3d candidate =
            world_from_model * motion * model.bodies[i].stood_from_model.inverse();
        const Eigen::Vector3d up = candidate.linear().col(2);
        const double tilt = std::atan2(up.head<2>().norm(), up.z());
        if (tilt >= least) continue;
        least = tilt;
        nearest = i;
        world_from_body = candidate;
      }
    const SceneModel& body = model.bodies[nearest];
    const Eigen::Matrix3d& turn = world_from_body.linear();
    // The yaw of the nearest turn about z.
    const double yaw = std::atan2(turn(1, 0) - turn(0, 1), turn(0, 0) + turn(1, 1));
    const Eigen::Vector3d at = world_from_body.translation();
    scene.truth.push_back(
        {annotated.model + nearest, {at.x(), at.y(), body.symmetry.canonical_yaw(yaw)}, body.symmetry});
    BopTruthResidual residual{least, std::nullopt};
    if (scene.table_height) residual.lift = at.z() - (*scene.table_height + body.base);
    residuals.push_back(residual);
  }
  return residuals;
}

}  // namespace perch
