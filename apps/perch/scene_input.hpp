#pragma once

#include <filesystem>

#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// A scene as read and then prepared. Throws InputError naming the file.
Scene read_prepared_scene(const std::filesystem::path& file, const Settings& settings,
                          const Executor& executor);

}  // namespace perch::app
