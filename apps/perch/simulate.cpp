#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <set>

#include "command.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/parallel/executor.hpp"
#include "perch/sim/bop_set.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/model_catalogue.hpp"
#include "perch/sim/parametric_models.hpp"
#include "perch/sim/scene_maker.hpp"
#include "perch/sim/scene_set.hpp"
#include "perch/sim/sensor_fields.hpp"
#include "simulate_pictures.hpp"

namespace perch::app {
namespace {

constexpr std::uint64_t most_pictured = 6;

/// As given; what isn't keeps the recipe's default.
struct SimulateOptions {
  std::string output, layout = "tabletop", sensor = "kinect";
  std::string scenes = "1", first = "0", seed = "1", threads = "0";
  std::optional<std::string> objects, repeats, models, visible, distance, elevation, azimuth, workspace, gap,
      image;
  std::vector<std::string> assignments;
  bool table = false, bop = false, models_only = false, picture = false, quiet = false;
};

/// A number at the beginning of the text, which is shortened by it. Throws InvalidSetting where there is
/// none.
template <typename T>
T leading_number(const char* flag, const std::string& whole, std::string_view& text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc())
    throw InvalidSetting(fmt::format("{} '{}': a number is missing or out of range", flag, whole));
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

template <typename T>
T whole_text(const char* flag, const std::string& text, T least, T most) {
  std::string_view rest = text;
  const T value = leading_number<T>(flag, text, rest);
  if (!rest.empty() || value < least || value > most)
    throw InvalidSetting(fmt::format("{} '{}': give a number from {} to {}", flag, text, least, most));
  return value;
}

/// "A-B" (or whatever stands between), or where it may be one, "A" for both.
template <typename T>
std::pair<T, T> two_numbers(const char* flag, const std::string& text, char between, bool one_will_do) {
  std::string_view rest = text;
  const T first = leading_number<T>(flag, text, rest);
  if (rest.empty() && one_will_do) return {first, first};
  if (rest.empty() || rest.front() != between)
    throw InvalidSetting(
        fmt::format("{} '{}': give two numbers, A{}B{}", flag, text, between, one_will_do ? ", or one" : ""));
  rest.remove_prefix(1);
  const T second = leading_number<T>(flag, text, rest);
  if (!rest.empty()) throw InvalidSetting(fmt::format("{} '{}': what is '{}' at its end?", flag, text, rest));
  return {first, second};
}

void read_span(const char* flag, const std::optional<std::string>& text, Span& span) {
  if (!text) return;
  const auto [least, most] = two_numbers<double>(flag, *text, '-', true);
  span = {least, most};
}

std::vector<std::string> model_names(const std::string& list) {
  if (list == "household") return household_model_names();
  if (list == "catalogue") return catalogue_model_names();
  if (list == "chess") return chess_model_names();
  std::vector<std::string> names;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = list.find(',', begin);
    names.push_back(list.substr(begin, end - begin));
    named_model(names.back());
  }
  return names;
}

SceneRecipe read_recipe(const SimulateOptions& o) {
  const bool chess = o.layout == "chess";
  if (!chess && o.layout != "tabletop")
    throw InvalidSetting(fmt::format("--layout '{}': known are tabletop, chess", o.layout));
  SceneRecipe recipe = chess ? SceneRecipe::chess() : SceneRecipe{};
  if (chess)
    for (const auto& [flag, given] : {std::pair("--models", o.models.has_value()),
                                      {"--repeats", o.repeats.has_value()},
                                      {"--workspace", o.workspace.has_value()}})
      if (given)
        throw InvalidSetting(fmt::format("{} has no meaning with --layout chess; leave one out", flag));
  if (!chess)
    recipe.models = blaming("--models", [&] { return model_names(o.models.value_or("catalogue")); });
  if (o.objects)
    std::tie(recipe.min_objects, recipe.max_objects) = two_numbers<int>("--objects", *o.objects, '-', true);
  if (o.repeats) recipe.repeats = whole_text<int>("--repeats", *o.repeats, 1, 255);
  read_span("--visible", o.visible, recipe.visible);
  read_span("--distance", o.distance, recipe.distance);
  read_span("--elevation-deg", o.elevation, recipe.elevation_deg);
  read_span("--azimuth-deg", o.azimuth, recipe.azimuth_deg);
  if (o.workspace)
    std::tie(recipe.workspace_x, recipe.workspace_y) =
        two_numbers<double>("--workspace", *o.workspace, 'x', false);
  if (o.gap) recipe.least_gap = whole_text<double>("--gap", *o.gap, 0.0, 1.0);
  if (o.image) std::tie(recipe.width, recipe.height) = two_numbers<int>("--image", *o.image, 'x', false);
  recipe.table = o.table || o.bop;
  recipe.sensor = blaming("--sensor", [&] { return named_sensor(o.sensor); });
  for (const std::string& assignment : o.assignments) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos)
      throw InvalidSetting(
          fmt::format("--set {}: give key=value, e.g. --set sensor.disparity_noise=0.1", assignment));
    set_sensor_field(recipe.sensor, assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  recipe.check();
  return recipe;
}

/// One line on the terminal that is written over and over; silent where stderr is no terminal.
class SceneCounter {
 public:
  SceneCounter(bool quiet, std::uint64_t total)
      : shown_(!quiet && isatty(STDERR_FILENO) != 0), total_(total) {}
  ~SceneCounter() {
    if (written_) fmt::print(stderr, "\r\033[K");
  }

  /// Called with the scenes done so far.
  void operator()(std::uint64_t done) {
    if (!shown_ || (written_ && since_last_.seconds() < 0.1)) return;
    since_last_ = Stopwatch();
    written_ = true;
    const double left = watch_.seconds() / static_cast<double>(done) * static_cast<double>(total_ - done);
    fmt::print(stderr, "\r\033[K{} of {} scenes, {:.0f} s left", done, total_, left);
  }

 private:
  bool shown_;
  bool written_ = false;
  std::uint64_t total_;
  Stopwatch watch_, since_last_;
};

/// What was made, for people.
struct SceneTally {
  std::uint64_t scenes = 0, objects = 0;
  std::set<std::string> models;
  std::vector<float> visible;

  void add(const SimulatedScene& made) {
    ++scenes;
    objects += made.scene.objects.size();
    for (const SceneModel& model : made.scene.models) models.insert(model.name);
    for (const double fraction : made.visible_fractions) visible.push_back(static_cast<float>(fraction));
  }
  void print(const std::string& folder) {
    std::sort(visible.begin(), visible.end());
    fmt::print(
        "{} scenes in {}: {} objects of {} models; visible: {:.0f} % at least, {:.0f} % in the median\n",
        scenes, folder, objects, models.size(), 100.0F * visible.front(),
        100.0F * visible[visible.size() / 2]);
  }
};

void print_models(const std::vector<SceneModel>& models) {
  fmt::print("{:<20} {:>10} {:>9}  {}\n", "model", "symmetry", "triangles", "size [mm]");
  for (const SceneModel& model : models) {
    const Eigen::Vector3f size = 1000.0F * model.mesh.bounds().sizes();
    fmt::print("{:<20} {:>10} {:>9}  {:.0f} x {:.0f} x {:.0f}\n", model.name, model.symmetry.name(),
               model.mesh.triangles.size(), size.x(), size.y(), size.z());
  }
}

/// The first of the errors by scene, so that it is the same at any number of threads.
struct FirstError {
  std::atomic<std::uint64_t> index{UINT64_MAX};
  std::string message;
  std::mutex mutex;

  void report(std::uint64_t at, const std::string& what) {
    const std::lock_guard lock(mutex);
    if (at >= index) return;
    message = what;
    index = at;
  }
};

/// Makes the scenes and hands each to `write`, from several threads; writes the picture, where one is asked
/// for, to `folder`.
SceneTally make_scenes(const SimulateOptions& options, const SceneMaker& maker, std::uint64_t first,
                       std::uint64_t count, std::uint64_t set_seed, const Executor& executor,
                       const std::filesystem::path& folder,
                       const std::function<void(std::uint64_t, const MadeScene&)>& write) {
  FirstError error;
  SceneTally tally;
  SceneCounter counter(options.quiet, count);
  std::vector<SceneThumbnail> thumbnails(options.picture ? std::min(count, most_pictured) : 0);
  std::mutex tally_mutex;
  executor.for_each(
      count,
      [&](std::size_t i, std::size_t) {
        const std::uint64_t index = first + i;
        if (index > error.index) return;
        try {
          const MadeScene made = maker.make(scene_seed(set_seed, index));
          write(index, made);
          if (i < thumbnails.size())
            thumbnails[i] = thumbnail(made, fmt::format("scene {}, {}", index, options.sensor));
          const std::lock_guard lock(tally_mutex);
          tally.add(made.simulated);
          counter(tally.scenes);
        } catch (const InputError& e) {
          error.report(index, e.what());
        }
      },
      StopCondition());
  if (error.index != UINT64_MAX)
    throw InputError(
        fmt::format("{}: scene {}: {}", shown(options.output), error.index.load(), error.message));
  if (!thumbnails.empty()) write_atomically(folder / "picture.png", draw_scenes(thumbnails));
  return tally;
}

void write_scenes(const SimulateOptions& options, const SceneMaker& maker, std::uint64_t first,
                  std::uint64_t count, std::uint64_t set_seed, const Executor& executor) {
  SceneTally tally;
  if (options.bop) {
    BopSetFolder folder(options.output, maker.models());
    tally = make_scenes(options, maker, first, count, set_seed, executor, folder.path(),
                        [&](std::uint64_t index, const MadeScene& made) { folder.write_scene(index, made); });
    folder.finish();
  } else {
    SceneSetFolder folder(options.output);
    for (std::uint64_t i = 0; i < count; ++i) folder.check_free(first + i);
    folder.write_models(maker.models());
    folder.remember(first, count);
    tally = make_scenes(options, maker, first, count, set_seed, executor, folder.path(),
                        [&](std::uint64_t index, const MadeScene& made) {
                          folder.write_scene(
                              index, made,
                              fmt::format("Scene {} of seed {}, made by perch simulate: {}, sensor {}.",
                                          index, set_seed, options.layout, options.sensor));
                        });
    folder.keep();
  }
  if (!options.quiet) tally.print(shown(options.output));
}

int simulate_scenes(const SimulateOptions& options) {
  const auto first = whole_text<std::uint64_t>("--first", options.first, 0, most_scenes - 1);
  const auto count = whole_text<std::uint64_t>("--scenes", options.scenes, 1, most_scenes - first);
  const auto seed = whole_text<std::uint64_t>("--seed", options.seed, 0, UINT64_MAX);
  const auto threads = whole_text<std::size_t>("--threads", options.threads, 0, 1024);
  if (options.bop && options.models_only)
    throw InvalidSetting("--bop and --models-only: a data set without images is none; leave one out");
  const SceneMaker maker(read_recipe(options));
  if (options.models_only) {
    SceneSetFolder folder(options.output);
    folder.write_models(maker.models());
    if (options.picture) write_atomically(folder.path() / "picture.png", draw_models(maker.models()));
    folder.keep();
    if (!options.quiet) print_models(maker.models());
  } else {
    write_scenes(options, maker, first, count, seed, *make_executor(threads));
  }
  return exit_solved;
}

std::string sensor_help() {
  std::string text = "set one field of the sensor, key=value, after --sensor. Fields, with those of kinect:";
  for (const SensorField& field : sensor_fields())
    text += fmt::format("\n{} [{}]: {}", field.key, field.get(DepthSensorSettings::kinect()), field.help);
  return text;
}

}  // namespace

void add_simulate(CLI::App& app, Run& run) {
  auto options = std::make_shared<SimulateOptions>();
  SimulateOptions& o = *options;
  CLI::App* command =
      app.add_subcommand("simulate", "make scenes of parametric objects as a depth camera sees them");
  command->footer(
      "Exit status: 0 all scenes are written; 2 bad usage, no such scenes, or no place to write: nothing "
      "is.");
  command->add_option("-o,--output", o.output, "folder for models/ and one folder a scene")->required();
  command->add_option("--scenes", o.scenes, "how many [1]");
  command->add_option("--first", o.first, "number of the first one [0]");
  command->add_option("--seed", o.seed, "of the set: seed and number determine a scene [1]");
  command->add_option("--layout", o.layout,
                      "tabletop, or chess: pieces on the squares of a board [tabletop]");
  command->add_option("--objects", o.objects, "how many, A-B or A [3-5; chess: 12]");
  command->add_option("--repeats", o.repeats, "copies of one of the models, all others stand there once [1]");
  command->add_option("--models", o.models, "catalogue, household, chess, or names: a,b,c [catalogue]");
  command->add_option("--visible", o.visible,
                      "A-B: of every object at least A, of the most hidden one at most B is visible [0.2-1]");
  command->add_option("--distance", o.distance, "camera to the workspace's middle, metres, A-B [0.8-1]");
  command->add_option("--elevation-deg", o.elevation, "how far the camera looks down, degrees, A-B [25-45]");
  command->add_option("--azimuth-deg", o.azimuth,
                      "from which side; 0: from -y, 90: from +x, degrees, A-B [0-360]");
  command->add_option("--workspace", o.workspace,
                      "where origins are put, metres, XxY about the world's origin [0.44x0.32]");
  command->add_option("--gap", o.gap, "least distance of two objects seen from above, metres [0.005]");
  command->add_option("--image", o.image, "size in pixels, WxH; the field of view stays [640x480]");
  command->add_option("--sensor", o.sensor, fmt::format("{} [kinect]", fmt::join(sensor_names(), ", ")));
  command->add_option("--set", o.assignments, sensor_help())->allow_extra_args(false);
  command->add_flag("--table", o.table, "leave the table in the depth image and write a mask of the objects");
  command->add_flag(
      "--bop", o.bop,
      "write a data set in BOP layout instead, with the table in view: a scene with one image for each");
  command->add_flag("--models-only", o.models_only, "write the meshes alone, and list them");
  command->add_flag("--picture", o.picture,
                    "write picture.png: the first scenes, or with --models-only the models");
  command->add_option("--threads", o.threads, "0: as many as the machine has [0]");
  command->add_flag("-q,--quiet", o.quiet, "no progress line and no summary");
  command->callback([options, &run] { run = [options] { return simulate_scenes(*options); }; });
}

}  // namespace perch::app
