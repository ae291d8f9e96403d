#include "perch/sim/scene_set.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/message.hpp"
#include "perch/io/png.hpp"
#include "perch/io/read_file.hpp"
#include "perch/sim/scene_folder.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

template <typename Items, typename Text>
std::string json_list(const Items& items, const Text& text) {
  std::vector<std::string> texts;
  for (const auto& item : items) texts.push_back(text(item));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string json_matrix(const Eigen::MatrixXd& matrix) {
  std::vector<std::string> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    std::vector<std::string> row;
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(exact_number(matrix(i, j)));
    rows.push_back(fmt::format("[{}]", fmt::join(row, ", ")));
  }
  return fmt::format("[{}]", fmt::join(rows, ", "));
}

}  // namespace

std::string scene_folder_name(std::uint64_t index) {
  return fmt::format("{:06}", index);
}

std::string truth_json(const MadeScene& made) {
  const Scene& scene = made.simulated.scene;
  const Intrinsics& k = scene.camera.intrinsics;
  Eigen::Matrix3d calibration;
  calibration << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  const auto quoted = [](const std::string& text) { return '"' + text + '"'; };
  const auto whole = [](std::int64_t n) { return std::to_string(n); };
  std::string symmetries;
  for (const SceneModel& model : scene.models) {
    const std::string name = model.symmetry.name();
    const bool is_number = model.symmetry.fold() > 1;
    symmetries += fmt::format("{}\"{}\": {}", symmetries.empty() ? "" : ", ", model.name,
                              is_number ? name : quoted(name));
  }
  std::string text = "{\n";
  text += fmt::format(" \"names\": {},\n", json_list(scene.truth, [&](const TruthPose& t) {
                        return quoted(scene.models[t.model].name);
                      }));
  text += fmt::format(" \"poses\": {},\n", json_list(scene.truth, [](const TruthPose& t) {
                        return fmt::format("[{}, {}, {}]", exact_number(t.pose.x), exact_number(t.pose.y),
                                           exact_number(t.pose.yaw));
                      }));
  text += fmt::format(" \"symmetry\": {{{}}},\n", symmetries);
  text += fmt::format(" \"visible\": {},\n", json_list(made.simulated.visible_fractions, exact_number));
  text += fmt::format(" \"visible_pixels\": {},\n", json_list(made.visible, whole));
  text += fmt::format(" \"alone_pixels\": {},\n", json_list(made.alone, whole));
  text += fmt::format(" \"world_from_camera\": {},\n", json_matrix(scene.camera.world_from_camera.matrix()));
  text += fmt::format(" \"K\": {},\n", json_matrix(calibration));
  text += fmt::format(" \"seed\": {}\n}}\n", made.seed);
  return text;
}

SceneSetFolder::SceneSetFolder(fs::path folder) : folder_(std::move(folder)) {
  folder_ = folder_.lexically_normal();
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  std::error_code ignored;
  for (fs::path p = folder_ / "models"; !p.empty() && !fs::exists(p, ignored); p = p.parent_path())
    made_folders_.push_back(p);
}

SceneSetFolder::~SceneSetFolder() {
  std::error_code ignored;
  for (std::uint64_t i = 0; i < count_; ++i) fs::remove_all(folder_ / scene_folder_name(first_ + i), ignored);
  for (const fs::path& model : made_models_) fs::remove(model, ignored);
  for (const fs::path& folder : made_folders_) fs::remove(folder, ignored);  // where they are empty
}

void SceneSetFolder::keep() {
  count_ = 0;
  made_models_.clear();
  made_folders_.clear();
}

void SceneSetFolder::remember(std::uint64_t first, std::uint64_t count) {
  first_ = first;
  count_ = count;
}

void SceneSetFolder::check_free(std::uint64_t index) const {
  std::error_code ignored;
  const fs::path folder = folder_ / scene_folder_name(index);
  if (fs::exists(fs::symlink_status(folder, ignored)))
    throw InputError(fmt::format("{}: is there already; choose another folder, remove it, or give --first",
                                 shown(folder)));
}

void SceneSetFolder::write_models(const std::vector<SceneModel>& models) {
  const fs::path folder = folder_ / "models";
  OutputSet files;
  for (const SceneModel& model : models) {
    const fs::path file = folder / (model.name + ".ply");
    std::string bytes = encode_ply(model.mesh);
    std::error_code ignored;
    if (!fs::exists(fs::symlink_status(file, ignored))) {
      made_models_.push_back(file);
      files.add(model.name + ".ply", std::move(bytes));
    } else if (read_file(file, std::uintmax_t{1} << 30) != bytes) {
      throw InputError(
          fmt::format("{}: is there already and is another mesh; choose another folder", shown(file)));
    }
  }
  files.commit(folder);
}

void SceneSetFolder::write_scene(std::uint64_t index, const MadeScene& made,
                                 const std::string& comment) const {
  const Scene& scene = made.simulated.scene;
  OutputSet files;
  files.add("depth.png", encode_png16_gray(counts_from_depth(scene.depth, scene.depth_scale)));
  if (scene.mask) files.add("mask.png", encode_png8_gray(*scene.mask));
  files.add("masks.png", encode_png8_gray(made.objects));
  files.add("truth.json", truth_json(made));
  files.add("scene.yaml", scene_yaml(made.simulated, comment, "../models"));
  files.create_folder(folder_ / scene_folder_name(index));
}

}  // namespace perch
