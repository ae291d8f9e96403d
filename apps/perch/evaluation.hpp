#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "command.hpp"
#include "evaluated_scenes.hpp"
#include "perch/eval/record.hpp"
#include "perch/localize/scene.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// A scene that results can be held against, prepared. Throws InputError as read_prepared_scene, and where it
/// has no truth.
Scene read_scene_with_truth(const std::filesystem::path& file, const Settings& settings,
                            const Executor& executor);

/// Holds the results in each folder against the truth of each scene. \param settings what J is counted with
/// where the command line says so; else it is as the result states. \param on_scene called before each scene
/// with its number; may be empty. Throws InputError for anything that can't be read, and for a scene without
/// truth.
std::vector<MethodRecord> evaluate_results(const std::vector<EvaluatedScene>& scenes,
                                           const std::vector<ResultFolder>& folders,
                                           const SettingsOptions& settings, const Executor& executor,
                                           const std::function<void(std::size_t)>& on_scene = {});

}  // namespace perch::app
