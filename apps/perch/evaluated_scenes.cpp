#include "evaluated_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

/// The last name in a path, also where it ends in a slash or a dot.
std::string last_name(const fs::path& path) {
  std::error_code error;
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

std::vector<fs::path> scenes_in(const fs::path& folder) {
  if (is_file(folder / "scene.yaml")) return {folder / "scene.yaml"};
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_file(entry->path() / "scene.yaml")) files.push_back(entry->path() / "scene.yaml");
  if (error)
    throw InputError(fmt::format("{}: can't be read ({}); check the folder", shown(folder), error.message()));
  if (files.empty())
    throw InputError(fmt::format(
        "{}: neither it nor a folder in it holds a scene.yaml; name scene files, or another folder",
        shown(folder)));
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::vector<EvaluatedScene> find_scenes(const std::vector<std::string>& arguments) {
  std::vector<EvaluatedScene> scenes;
  bool only_files = true;
  for (const std::string& argument : arguments) {
    if (is_folder(argument)) {
      only_files = false;
      for (const fs::path& file : scenes_in(argument)) scenes.push_back({file, {}, {}, false});
    } else {
      scenes.push_back({argument, {}, {}, false});
    }
  }
  std::map<std::string, fs::path> files;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    EvaluatedScene& scene = scenes[i];
    std::error_code error;
    scene.name = last_name(fs::absolute(scene.file, error).parent_path());
    scene.only = scenes.size() == 1;
    if (only_files && !scene.only) scene.indexed_name = fmt::format("{}_{}", i, scene.file.stem().string());
    const auto [other, is_new] = files.emplace(scene.name, scene.file);
    if (!is_new)
      throw InputError(fmt::format(
          "{}: {} lies in a folder of the same name, {}, and results are told apart by it; evaluate them one "
          "after the other",
          shown(scene.file), shown(other->second), one_line(scene.name)));
  }
  return scenes;
}

std::vector<ResultFolder> result_folders(const std::vector<std::string>& arguments) {
  std::vector<ResultFolder> folders;
  std::set<std::string> names;
  for (const std::string& argument : arguments) {
    const std::size_t equals = argument.find('=');
    ResultFolder folder;
    folder.folder = equals == std::string::npos ? argument : argument.substr(equals + 1);
    folder.method = equals == std::string::npos ? last_name(folder.folder) : argument.substr(0, equals);
    if (!is_folder(folder.folder))
      throw InputError(
          fmt::format("--results: {}: is no folder; give DIR or NAME=DIR", shown(folder.folder)));
    if (folder.method.empty())
      throw InputError(
          fmt::format("--results: {}: has no name before the =; give DIR or NAME=DIR", one_line(argument)));
    if (!names.insert(folder.method).second)
      throw InputError(fmt::format("--results: two methods are named {}; give them names, NAME=DIR",
                                   one_line(folder.method)));
    folders.push_back(folder);
  }
  return folders;
}

std::optional<fs::path> result_of(const EvaluatedScene& scene, const fs::path& folder) {
  std::set<fs::path> found;
  const auto look = [&](const fs::path& file) {
    std::error_code error;
    if (fs::exists(file, error)) found.insert(file);
  };
  look(folder / scene.name / "result.json");
  if (scene.indexed_name) look(folder / *scene.indexed_name / "result.json");
  if (scene.only) look(folder / "result.json");
  if (found.size() > 1)
    throw InputError(fmt::format("{}: {} may be the result of the same scene; leave one",
                                 shown(*found.begin()), shown(*std::next(found.begin()))));
  return found.empty() ? std::nullopt : std::optional(*found.begin());
}

}  // namespace perch::app
