#pragma once

#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// The scene with all that its file leaves to be found out: what every command works on after reading a
/// scene. A scene that leaves nothing open, or is prepared already, is returned as it is. Throws InputError,
/// InvalidSetting.
Scene prepare(Scene scene, const Settings& settings, const Executor& executor);

}  // namespace perch
