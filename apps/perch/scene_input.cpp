#include "scene_input.hpp"

#include "command.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/localize/prepare.hpp"

namespace perch::app {

Scene read_prepared_scene(const std::filesystem::path& file, const Settings& settings,
                          const Executor& executor) {
  Scene scene = read_scene(file);
  return blaming(file.string(), [&] { return prepare(std::move(scene), settings, executor); });
}

}  // namespace perch::app
