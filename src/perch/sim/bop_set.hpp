#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "perch/sim/scene_maker.hpp"

namespace perch {

/// A set of simulated scenes in BOP layout (docs/bop.md), lengths in millimetres: models/, camera.json,
/// test_targets_bop19.json, and a scene with one image, number 0, for each scene that is made. As in BOP the
/// origin of a model is the middle of its box. There is no rgb/: nothing here has a colour.
///
/// The folder appears with everything in it when it is finished, or not at all.
class BopSetFolder {
 public:
  /// Throws InputError where there is something of that name, or no place to write.
  BopSetFolder(const std::filesystem::path& folder, const std::vector<SceneModel>& models);
  ~BopSetFolder();
  BopSetFolder(const BopSetFolder&) = delete;
  BopSetFolder& operator=(const BopSetFolder&) = delete;

  /// Writes a scene of these models. May be called from several threads for different indices. Throws
  /// InputError.
  void write_scene(std::uint64_t index, const MadeScene& made);
  /// Writes the list of targets and lets the folder appear. Throws InputError.
  void finish();
  /// Where the files are until it is finished.
  const std::filesystem::path& path() const { return part_; }

 private:
  std::filesystem::path folder_, part_;
  std::vector<std::filesystem::path> made_folders_;  ///< on the way to it, the lowest first
  std::vector<SceneModel> models_;
  std::mutex mutex_;
  std::map<std::uint64_t, std::string> targets_;  ///< of each scene, as JSON
  std::string camera_;                            ///< camera.json
};

}  // namespace perch
