#include "output.hpp"

#include <algorithm>
#include <optional>
#include <system_error>

#include "perch/io/png.hpp"
#include "perch/io/result_json.hpp"
#include "perch/localize/rendering.hpp"
#include "picture.hpp"

namespace perch::app {
namespace {

constexpr const char* rendered_depth = "rendered_depth.png";

}  // namespace

void rehearse_outputs(const std::filesystem::path& directory) {
  OutputSet outputs;
  for (const char* name : {"result.json", "trace.jsonl", rendered_depth, "picture.png"})
    outputs.add(name, "");
  outputs.rehearse(directory);
}

OutputSet make_outputs(const Scene& scene, const Result& result, const Settings& settings,
                       const Executor& executor) {
  std::optional<SceneRendering> rendering;
  if (result.cost) rendering = render_scene(scene, placed_objects(scene, result), settings, executor);
  OutputSet outputs;
  outputs.add("trace.jsonl", to_json_lines(result.trace));
  if (rendering)
    outputs.add(rendered_depth, encode_png16_gray(counts_from_depth(rendering->depth, scene.depth_scale)));
  Result shown = result;
  std::erase_if(shown.objects, [](const ObjectResult& object) { return object.absent; });
  outputs.add("picture.png", draw_picture(scene, shown, rendering ? &*rendering : nullptr));
  // Last: where it lies, the others do.
  outputs.add("result.json", to_json(result));
  return outputs;
}

void write_outputs(const OutputSet& outputs, const std::filesystem::path& directory) {
  outputs.commit(directory);
  const auto& files = outputs.files();
  const bool rendering =
      std::any_of(files.begin(), files.end(), [](const auto& file) { return file.first == rendered_depth; });
  // Beside a result without a scene, an older rendering would pass for its own.
  std::error_code ignored;
  if (!rendering) std::filesystem::remove(directory / rendered_depth, ignored);
}

void write_outputs(const Scene& scene, const Result& result, const Settings& settings,
                   const Executor& executor, const std::filesystem::path& directory) {
  write_outputs(make_outputs(scene, result, settings, executor), directory);
}

}  // namespace perch::app
