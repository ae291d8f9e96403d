#include <fmt/format.h>

#include "command.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/poses_file.hpp"
#include "perch/io/result_json.hpp"
#include "perch/localize/localize.hpp"
#include "scene_input.hpp"

namespace perch::app {
namespace {

struct ScoreOptions {
  std::string scene, poses, output;
  SettingsOptions settings;
};

int score_scene_file(const ScoreOptions& options) {
  const Settings settings = options.settings.read();
  const auto executor = make_executor(settings.threads);
  const Scene scene = read_prepared_scene(options.scene, settings, *executor);
  const auto poses = read_poses(options.poses, scene);
  const std::string json =
      to_json(blaming(options.scene, [&] { return score(scene, poses, settings, *executor); }));
  if (!options.output.empty()) {
    OutputSet outputs;
    outputs.add("score.json", json);
    outputs.commit(options.output);
  }
  fmt::print("{}", json);
  return exit_solved;
}

}  // namespace

void add_score(CLI::App& app, Run& run) {
  auto options = std::make_shared<ScoreOptions>();
  CLI::App* command = app.add_subcommand("score", "the explanation cost of given scenes, as a JSON array");
  command->add_option("scene", options->scene, "scene file (YAML)")->required();
  command->add_option("--poses", options->poses, "JSON array of arrays of {model, x, y, yaw}")->required();
  command->add_option("-o,--output", options->output, "folder for score.json");
  options->settings.add_to(*command, {{"--delta", "cost.delta"}, {"--threads", "threads"}});
  command->callback([options, &run] { run = [options] { return score_scene_file(*options); }; });
}

}  // namespace perch::app
