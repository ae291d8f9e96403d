#pragma once

#include "perch/core/bytes.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"

namespace perch {

/// What make_problem needs of a prepared scene, as it goes to other processes: no colours, no priors, no
/// truth.
void write_scene(ByteWriter& to, const Scene& scene);
Scene read_scene(ByteReader& from);

void write_settings(ByteWriter& to, const Settings& settings);
Settings read_settings(ByteReader& from);

}  // namespace perch
