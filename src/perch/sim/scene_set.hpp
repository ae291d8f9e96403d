#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "perch/sim/scene_maker.hpp"

namespace perch {

/// Most scenes of a set; folders are named by six digits.
inline constexpr std::uint64_t most_scenes = 1'000'000;

/// "000017".
std::string scene_folder_name(std::uint64_t index);

/// Where a set of scenes goes: models/NAME.ply, and for each scene a folder that names these meshes. What was
/// written is removed again unless it is kept.
class SceneSetFolder {
 public:
  explicit SceneSetFolder(std::filesystem::path folder);
  ~SceneSetFolder();
  SceneSetFolder(const SceneSetFolder&) = delete;
  SceneSetFolder& operator=(const SceneSetFolder&) = delete;

  /// Throws InputError where there is a folder of that index already.
  void check_free(std::uint64_t index) const;
  /// All of them or none; files that are there already must be the same. Throws InputError.
  void write_models(const std::vector<SceneModel>& models);
  /// scene.yaml, truth.json, depth.png, mask.png and masks.png, in a folder that appears with all of them.
  /// May be called from several threads for different indices. Throws InputError.
  void write_scene(std::uint64_t index, const MadeScene& made, const std::string& comment) const;
  /// Scenes that write_scene may have written, to be removed unless they are kept.
  void remember(std::uint64_t first, std::uint64_t count);
  void keep();
  const std::filesystem::path& path() const { return folder_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> made_folders_, made_models_;
  std::uint64_t first_ = 0, count_ = 0;
};

/// What is true of a scene beyond its file, in JSON; the order is that of the scene's `objects`:
/// `names`, `poses` [x, y, yaw], `symmetry` by model, `visible` (fractions), `visible_pixels`,
/// `alone_pixels`, `world_from_camera`, `K`, `seed`.
std::string truth_json(const MadeScene& made);

}  // namespace perch
