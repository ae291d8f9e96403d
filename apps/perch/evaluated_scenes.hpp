#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

// Which scenes are evaluated, and where their results lie.
namespace perch::app {

struct EvaluatedScene {
  std::filesystem::path file;
  std::string name;  ///< of the folder that holds the file; no two scenes have the same
  /// `<index>_<file name without ending>`, the folder in which `perch localize` puts the result where it is
  /// given the same scene files; empty where not all scenes were given as files.
  std::optional<std::string> indexed_name;
  bool only = false;  ///< no other scene is evaluated
};

/// The scenes that the arguments name: files; folders that hold a scene.yaml; and folders whose direct
/// subfolders do, those in order of their names. Throws InputError, one line, for anything else and for two
/// scenes of one name.
std::vector<EvaluatedScene> find_scenes(const std::vector<std::string>& arguments);

/// The results of one method.
struct ResultFolder {
  std::string method;
  std::filesystem::path folder;
};

/// Reads `NAME=DIR` or `DIR`, where the folder's own name is the method's. Throws InputError for a folder
/// that is not there and for two methods of one name.
std::vector<ResultFolder> result_folders(const std::vector<std::string>& arguments);

/// The result.json of a scene: in `folder`/name, in `folder`/indexed_name or, of an only scene, in `folder`
/// itself. Empty where there is none. Throws InputError where there are several.
std::optional<std::filesystem::path> result_of(const EvaluatedScene& scene,
                                               const std::filesystem::path& folder);

}  // namespace perch::app
