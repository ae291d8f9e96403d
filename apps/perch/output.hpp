#pragma once

#include <filesystem>

#include "perch/io/atomic_write.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch::app {

/// Throws InputError where write_outputs would, for reasons that can be seen beforehand. Leaves nothing.
void rehearse_outputs(const std::filesystem::path& directory);

/// result.json, trace.jsonl, picture.png and, where there is a scene, rendered_depth.png.
OutputSet make_outputs(const Scene& scene, const Result& result, const Settings& settings,
                       const Executor& executor);

/// Writes what make_outputs made: all files or none. Where there is no scene, the rendered_depth.png of an
/// earlier run is removed. Throws InputError where they can't be written.
void write_outputs(const OutputSet& outputs, const std::filesystem::path& directory);

/// Makes and writes them.
void write_outputs(const Scene& scene, const Result& result, const Settings& settings,
                   const Executor& executor, const std::filesystem::path& directory);

}  // namespace perch::app
