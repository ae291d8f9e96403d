#include "output.hpp"

#include <optional>
#include <system_error>

#include "perch/io/atomic_write.hpp"
#include "perch/io/png.hpp"
#include "perch/io/result_json.hpp"
#include "perch/localize/rendering.hpp"
#include "picture.hpp"

namespace perch::app {

void rehearse_outputs(const std::filesystem::path& directory) {
  OutputSet outputs;
  for (const char* name : {"result.json", "trace.jsonl", "rendered_depth.png", "picture.png"})
    outputs.add(name, "");
  outputs.rehearse(directory);
}

void write_outputs(const Scene& scene, const Result& result, const Settings& settings,
                   const Executor& executor, const std::filesystem::path& directory) {
  std::optional<SceneRendering> rendering;
  if (result.cost) rendering = render_scene(scene, placed_objects(scene, result), settings, executor);
  OutputSet outputs;
  outputs.add("result.json", to_json(result));
  outputs.add("trace.jsonl", to_json_lines(result.trace));
  if (rendering)
    outputs.add("rendered_depth.png",
                encode_png16_gray(counts_from_depth(rendering->depth, scene.depth_scale)));
  Result shown = result;
  std::erase_if(shown.objects, [](const ObjectResult& object) { return object.absent; });
  outputs.add("picture.png", draw_picture(scene, shown, rendering ? &*rendering : nullptr));
  outputs.commit(directory);
  // Beside a result without a scene, an older rendering would pass for its own.
  std::error_code ignored;
  if (!rendering) std::filesystem::remove(directory / "rendered_depth.png", ignored);
}

}  // namespace perch::app
