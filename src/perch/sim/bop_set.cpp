#include "perch/sim/bop_set.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <numbers>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/message.hpp"
#include "perch/io/png.hpp"
#include "perch/model/convex_hull.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/sim/scene_folder.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

constexpr double mm_per_metre = 1000.0;

std::string number_list(const std::vector<double>& numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(exact_number(number));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string millimetres(const Eigen::Vector3d& metres) {
  const Eigen::Vector3d mm = mm_per_metre * metres;
  return number_list({mm.x(), mm.y(), mm.z()});
}

std::string rows_of(const Eigen::MatrixXd& matrix) {
  std::vector<double> numbers;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) numbers.push_back(matrix(i, j));
  return number_list(numbers);
}

Eigen::Vector3d middle_of(const Mesh& mesh) {
  const Eigen::AlignedBox3d box = mesh.bounds().cast<double>();
  return box.center();
}

Mesh bop_mesh(const Mesh& mesh) {
  const Eigen::Vector3d middle = middle_of(mesh);
  Mesh moved_mesh = mesh;
  for (Eigen::Vector3f& p : moved_mesh.vertices)
    p = (mm_per_metre * (p.cast<double>() - middle)).cast<float>();
  return moved_mesh;
}

/// The entry of models_info.json, without its key.
std::string model_info(const SceneModel& model) {
  const Mesh mesh = bop_mesh(model.mesh);
  const Eigen::AlignedBox3f box = mesh.bounds();
  const Eigen::Vector3f least = box.min(), size = box.sizes();
  std::string text = fmt::format("{{\"diameter\": {}", exact_number(hull_diameter(convex_hull(mesh))));
  for (int axis = 0; axis < 3; ++axis)
    text += fmt::format(", \"min_{0}\": {1}, \"size_{0}\": {2}", "xyz"[axis],
                        exact_number(double{least[axis]}), exact_number(double{size[axis]}));
  // About the axis of the mesh's own frame, which need not run through the middle of its box.
  Eigen::Vector3d axis = -middle_of(model.mesh);
  axis.z() = 0.0;
  if (model.symmetry.is_continuous())
    text += fmt::format(", \"symmetries_continuous\": [{{\"axis\": [0, 0, 1], \"offset\": {}}}]",
                        millimetres(axis));
  if (model.symmetry.fold() > 1) {
    std::vector<std::string> turns;
    for (int i = 1; i < model.symmetry.fold(); ++i) {
      Eigen::Isometry3d turn = Eigen::Translation3d(mm_per_metre * axis) *
                               Eigen::AngleAxisd(i * model.symmetry.period(), Eigen::Vector3d::UnitZ()) *
                               Eigen::Translation3d(-mm_per_metre * axis);
      turns.push_back(rows_of(turn.matrix()));
    }
    text += fmt::format(", \"symmetries_discrete\": [{}]", fmt::join(turns, ", "));
  }
  return text + "}";
}

/// The smallest window around the pixels for which `holds`, as x, y, width, height; -1 in each without any.
template <typename Holds>
std::string box_of(const Window& window, const Holds& holds) {
  int u0 = window.u1, u1 = window.u0 - 1, v0 = window.v1, v1 = window.v0 - 1;
  for (int v = window.v0; v < window.v1; ++v)
    for (int u = window.u0; u < window.u1; ++u)
      if (holds(u, v)) {
        u0 = std::min(u0, u);
        u1 = std::max(u1, u);
        v0 = std::min(v0, v);
        v1 = std::max(v1, v);
      }
  if (u1 < u0) return "[-1, -1, -1, -1]";
  return fmt::format("[{}, {}, {}, {}]", u0, v0, u1 - u0 + 1, v1 - v0 + 1);
}

std::string camera_json(const Intrinsics& k, double depth_scale) {
  return fmt::format(
      "{{\"cx\": {}, \"cy\": {}, \"depth_scale\": {}, \"fx\": {}, \"fy\": {}, \"height\": {}, \"width\": "
      "{}}}\n",
      exact_number(k.cx), exact_number(k.cy), exact_number(mm_per_metre * depth_scale), exact_number(k.fx),
      exact_number(k.fy), k.height, k.width);
}

std::string scene_camera_json(const Scene& scene) {
  const Intrinsics& k = scene.camera.intrinsics;
  Eigen::Matrix3d calibration;
  calibration << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  const Eigen::Isometry3d camera_from_world = scene.camera.world_from_camera.inverse();
  return fmt::format(
      "{{\"0\": {{\"cam_K\": {}, \"depth_scale\": {}, \"cam_R_w2c\": {}, \"cam_t_w2c\": {}}}}}\n",
      rows_of(calibration), exact_number(mm_per_metre * scene.depth_scale),
      rows_of(camera_from_world.linear()), millimetres(camera_from_world.translation()));
}

}  // namespace

BopSetFolder::BopSetFolder(const fs::path& folder, const std::vector<SceneModel>& models)
    : folder_(folder.lexically_normal()), models_(models) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder_, error)))
    throw InputError(
        fmt::format("{}: is there already; choose another folder, or remove it", shown(folder_)));
  const fs::path parent = folder_.has_parent_path() ? folder_.parent_path() : fs::path(".");
  for (fs::path p = parent; !p.empty() && !fs::exists(p, error); p = p.parent_path())
    made_folders_.push_back(p);
  part_ = parent / fmt::format(".{}-{}.part", folder_.filename().string(), ::getpid());
  try {
    OutputSet files;
    std::vector<std::string> infos;
    for (std::size_t i = 0; i < models_.size(); ++i) {
      files.add(fmt::format("obj_{:06}.ply", i + 1), encode_ply(bop_mesh(models_[i].mesh)));
      infos.push_back(fmt::format("\n \"{}\": {}", i + 1, model_info(models_[i])));
    }
    files.add("models_info.json", fmt::format("{{{}\n}}\n", fmt::join(infos, ",")));
    files.commit(part_ / "models");
  } catch (...) {
    for (const fs::path& made : made_folders_) fs::remove(made, error);
    throw;
  }
}

BopSetFolder::~BopSetFolder() {
  std::error_code ignored;
  if (part_.empty()) return;
  fs::remove_all(part_, ignored);
  for (const fs::path& folder : made_folders_) fs::remove(folder, ignored);
}

void BopSetFolder::write_scene(std::uint64_t index, const MadeScene& made) {
  const Scene& scene = made.simulated.scene;
  const Intrinsics& intrinsics = scene.camera.intrinsics;
  const Eigen::Isometry3d camera_from_world = scene.camera.world_from_camera.inverse();
  OutputSet top, depth, masks, visible_masks;
  std::vector<std::string> truths, infos;
  std::map<std::size_t, int> count;  // of each obj_id
  Rasterizer rasterizer(intrinsics);
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    const SceneModel& model = scene.models[scene.truth[i].model];
    const auto named = [&](const SceneModel& m) { return m.name == model.name; };
    const auto obj_id =
        static_cast<std::size_t>(std::find_if(models_.begin(), models_.end(), named) - models_.begin()) + 1;
    ++count[obj_id];
    const Eigen::Isometry3d camera_from_mesh =
        camera_from_world * world_from_model(scene.truth[i].pose, model.base);
    const Eigen::Isometry3d camera_from_model =
        camera_from_mesh * Eigen::Translation3d(middle_of(model.mesh));
    truths.push_back(fmt::format("{{\"cam_R_m2c\": {}, \"cam_t_m2c\": {}, \"obj_id\": {}}}",
                                 rows_of(camera_from_model.linear()),
                                 millimetres(camera_from_model.translation()), obj_id));

    const DepthPatch alone = rasterizer.render(model.mesh, camera_from_mesh);
    Image<std::uint8_t> mask(intrinsics.width, intrinsics.height),
        visible(intrinsics.width, intrinsics.height);
    std::int64_t all = 0, valid = 0, seen = 0;
    for (int v = 0; v < intrinsics.height; ++v)
      for (int u = 0; u < intrinsics.width; ++u) {
        if (made.objects(u, v) == i + 1) {
          visible(u, v) = 255;
          ++seen;
        }
        if (!(alone.at_or_none(u, v) < no_surface)) continue;
        mask(u, v) = 255;
        ++all;
        valid += scene.depth(u, v) > 0.0F;
      }
    const Window whole = intrinsics.window();
    infos.push_back(
        fmt::format("{{\"bbox_obj\": {}, \"bbox_visib\": {}, \"px_count_all\": {}, \"px_count_valid\": {}, "
                    "\"px_count_visib\": {}, "
                    "\"visib_fract\": {}}}",
                    box_of(whole, [&](int u, int v) { return mask(u, v) != 0; }),
                    box_of(whole, [&](int u, int v) { return visible(u, v) != 0; }), all, valid, seen,
                    exact_number(all > 0 ? static_cast<double>(seen) / static_cast<double>(all) : 0.0)));
    const std::string name = fmt::format("000000_{:06}.png", i);
    masks.add(name, encode_png8_gray(mask));
    visible_masks.add(name, encode_png8_gray(visible));
  }
  depth.add("000000.png", encode_png16_gray(counts_from_depth(scene.depth, scene.depth_scale)));
  top.add("scene_camera.json", scene_camera_json(scene));
  top.add("scene_gt.json", fmt::format("{{\"0\": [{}]}}\n", fmt::join(truths, ",\n ")));
  top.add("scene_gt_info.json", fmt::format("{{\"0\": [{}]}}\n", fmt::join(infos, ",\n ")));

  const fs::path folder = part_ / "test" / fmt::format("{:06}", index);
  depth.commit(folder / "depth");
  masks.commit(folder / "mask");
  visible_masks.commit(folder / "mask_visib");
  top.commit(folder);

  std::vector<std::string> targets;
  for (const auto& [obj_id, copies] : count)
    targets.push_back(fmt::format("{{\"im_id\": 0, \"inst_count\": {}, \"obj_id\": {}, \"scene_id\": {}}}",
                                  copies, obj_id, index));
  const std::lock_guard lock(mutex_);
  targets_[index] = fmt::format("{}", fmt::join(targets, ",\n "));
  camera_ = camera_json(intrinsics, scene.depth_scale);
}

void BopSetFolder::finish() {
  std::vector<std::string> targets;
  for (const auto& [index, text] : targets_) targets.push_back(text);
  OutputSet top;
  top.add("camera.json", camera_);
  top.add("test_targets_bop19.json", fmt::format("[{}]\n", fmt::join(targets, ",\n ")));
  top.commit(part_);
  std::error_code error;
  fs::rename(part_, folder_, error);
  if (error)
    throw InputError(
        fmt::format("{}: can't be made ({}); choose another place", shown(folder_), error.message()));
  part_.clear();
}

}  // namespace perch
