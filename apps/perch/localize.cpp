#include "localize.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <optional>

#include "command.hpp"
#include "localize_bop.hpp"
#include "output.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/io/poses_file.hpp"
#include "perch/localize/localize.hpp"
#include "ranks.hpp"
#include "run_method.hpp"
#include "scene_input.hpp"

namespace perch::app {
namespace {

struct LocalizeOptions {
  std::vector<std::string> scenes;
  std::string output;
  bool quiet = false, anytime = false, exhaustive = false;
  std::optional<std::string> priors;
  BopLocalization bop;
  SettingsOptions settings;
};

/// One line on the terminal that is written over and over, a few times a second; silent where stderr is no
/// terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet) : shown_(!quiet && isatty(STDERR_FILENO) != 0) {}
  ~ProgressLine() {
    if (written_) fmt::print(stderr, "\r\033[K");
  }

  void operator()(const Progress& progress) {
    if (!shown_ || (written_ && since_last_.seconds() < 0.1)) return;
    since_last_ = Stopwatch();
    written_ = true;
    const std::string best = progress.best_cost ? std::to_string(*progress.best_cost) : "-";
    fmt::print(stderr, "\r\033[K{}: {} states, {} expansions, best cost {}, bound {}, {:.1f} s",
               progress.stage, progress.states, progress.expansions, best, progress.lower_bound,
               total_.seconds());
  }

 private:
  bool shown_;
  bool written_ = false;
  Stopwatch total_, since_last_;
};

}  // namespace

int exit_status(Status status) {
  switch (status) {
    case Status::solved:
    case Status::unproven:
      return exit_solved;
    case Status::infeasible:
      return exit_infeasible;
    case Status::time_limit:
      return exit_time_limit;
  }
  return exit_bad_input;
}

void print_table(const Scene& scene, const Result& result) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  const char* status = result.status == Status::solved       ? "solved"
                       : result.status == Status::infeasible ? "infeasible"
                       : result.status == Status::unproven   ? "unproven"
                                                             : "time limit";
  fmt::print("{}: {}: {}\n", scene.name, status, result.reason);
  if (!result.cost) return;
  const auto bound = result.suboptimality_bound();
  fmt::print("cost {} of {} observed points\n", result.cost->cost, result.observed_points);
  if (result.has_bound())
    fmt::print("search cost {}, lower bound {}, suboptimality bound {}\n", *result.search_cost,
               result.lower_bound, bound ? fmt::format("{:.3f}", *bound) : std::string("none"));
  fmt::print("{} hypotheses, {} expansions, {:.2f} s on {} threads{}\n", result.stats.rendered,
             result.stats.expanded, result.stats.seconds.total, result.stats.threads,
             result.stats.ranks > 1 ? fmt::format(" a rank, {} ranks", result.stats.ranks) : std::string());
  std::size_t width = 6;
  const auto label = [](const ObjectResult& object) {
    return object.rest_pose ? fmt::format("{}, rest pose {}", object.model, *object.rest_pose) : object.model;
  };
  for (const ObjectResult& object : result.objects) width = std::max(width, label(object).size());
  fmt::print("{:<{}}  {:>8} {:>8} {:>8} {:>8} {:>9} {:>10}\n", "object", width, "x [m]", "y [m]", "yaw [°]",
             "visible", "explained", "confidence");
  for (const ObjectResult& object : result.objects)
    if (object.absent)
      fmt::print("{:<{}}  absent\n", object.model, width);
    else
      fmt::print("{:<{}}  {:8.4f} {:8.4f} {:8.1f} {:7.0f}% {:8.0f}% {:>10}\n", label(object), width,
                 object.pose.x, object.pose.y, object.pose.yaw * degrees, 100.0 * object.visible_fraction,
                 100.0 * object.explained_fraction,
                 object.confidence ? fmt::format("{:.2f}", *object.confidence) : std::string("-"));
}

namespace {

void print_traffic(const Traffic& before, const Traffic& after, std::int64_t made_again) {
  const std::uint64_t messages = after.messages - before.messages, items = after.items - before.items,
                      news = after.news_bytes - before.news_bytes, bytes = after.bytes - before.bytes - news;
  if (items == 0) return;
  const auto each = [&](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(items); };
  fmt::print(
      "to and from the other ranks: {} questions, {:.0f} bytes and {:.3f} messages each; the problem {:.1f} "
      "MB\n",
      items, each(bytes), each(messages), 1e-6 * static_cast<double>(news));
  if (made_again > 0)
    fmt::print("{} hypotheses were made again, since another rank keeps what they are alone\n", made_again);
}

}  // namespace

Result localize_with_progress(const Scene& scene, const Settings& settings, const Executor& executor,
                              const StopCondition& stop, bool quiet, const std::string& blamed) {
  ProgressLine progress(quiet);
  return blaming(blamed, [&] {
    return run_method(scene, settings, executor, stop, [&](const Progress& p) { progress(p); });
  });
}

namespace {

Scene read_inputs(const std::string& file, const LocalizeOptions& options, const Settings& settings,
                  const Executor& executor) {
  Scene scene = read_prepared_scene(file, settings, executor);
  if (options.priors) scene.priors = read_priors(*options.priors, scene);
  return scene;
}

int localize_scenes(const LocalizeOptions& options, const Ranks& ranks) {
  const Stopwatch watch;
  Settings settings = options.settings.read();
  settings.anytime = settings.anytime || options.anytime;
  settings.exhaustive = settings.exhaustive || options.exhaustive;
  settings.check_together();
  check_built(settings.localization);
  if (options.priors && settings.localization != LocalizationMethod::perch)
    throw InvalidSetting(
        fmt::format("--priors: {} has no use for them; leave them out, or use --method perch",
                    name(settings.localization)));
  options.bop.check();
  const auto executor = ranks.executor(settings.threads);
  if (options.bop.given()) {
    if (!options.scenes.empty() || options.priors)
      throw InputError("--bop takes its images from a data set; leave out scene files and --priors");
    return localize_bop(options.bop, settings, *executor, options.output, options.quiet, watch);
  }
  if (options.scenes.empty())
    throw InputError("scenes is required; give scene files, or a data set with --bop");
  const std::size_t n = options.scenes.size();
  const auto output_of = [&](std::size_t i, const Scene& scene) {
    const std::filesystem::path directory(options.output);
    return n > 1 ? directory / fmt::format("{}_{}", i, scene.name) : directory;
  };
  // A broken one, or a place that can't be written to, is refused before any is worked on and written.
  std::optional<Scene> read;
  for (std::size_t i = 0; i < n; ++i) {
    read = read_inputs(options.scenes[i], options, settings, *executor);
    if (!options.output.empty()) rehearse_outputs(output_of(i, *read));
  }
  int status = exit_solved;
  for (std::size_t i = 0; i < n; ++i) {
    // Each scene gets its share of what is left of the command's time.
    const double left = (settings.time_limit - watch.seconds()) / static_cast<double>(n - i);
    const StopCondition stop = StopCondition::after(left);
    const Scene scene =
        n == 1 ? std::move(*read) : read_inputs(options.scenes[i], options, settings, *executor);
    const Traffic before = executor->traffic();
    const Result result =
        localize_with_progress(scene, settings, *executor, stop, options.quiet, options.scenes[i]);
    if (!options.output.empty()) write_outputs(scene, result, settings, *executor, output_of(i, scene));
    if (!options.quiet) {
      print_table(scene, result);
      print_traffic(before, executor->traffic(), result.stats.made_again);
    }
    if (result.status == Status::infeasible)
      fmt::print(stderr, "perch: {}: no solution: {}\n", scene.name, result.reason);
    status = std::max(status, exit_status(result.status));
  }
  return status;
}

}  // namespace

void add_localize(CLI::App& app, Run& run, const Ranks& ranks) {
  auto options = std::make_shared<LocalizeOptions>();
  CLI::App* command = app.add_subcommand("localize", "find the pose of every object of a scene");
  command->add_option("scenes", options->scenes, "scene files (YAML)");
  command->add_option("-o,--output", options->output,
                      "folder for result.json, rendered_depth.png and a picture");
  command->add_option(
      "--priors", options->priors,
      "JSON array of {model, x, y, yaw}: poses that another detector proposes; they guide the "
      "search, its guarantee stays");
  command->add_flag("--anytime", options->anytime,
                    "go on after the first solution until it is proven optimal or the time is up");
  command->add_flag("--exhaustive", options->exhaustive,
                    "value every scene instead of searching; for small grids");
  command->add_flag("-q,--quiet", options->quiet, "no progress line and no table");
  options->bop.add_to(*command);
  options->settings.add_to(*command, {{"--method", "method"},
                                      {"--w", "search.w"},
                                      {"--delta", "cost.delta"},
                                      {"--resolution", "grid.resolution"},
                                      {"--yaw-resolution-deg", "grid.yaw_resolution_deg"},
                                      {"--refine", "refine.method"},
                                      {"--candidates", "search.candidates"},
                                      {"--search", "search.method"},
                                      {"--time-limit", "search.time_limit"},
                                      {"--max-expansions", "search.max_expansions"},
                                      {"--threads", "threads"}});
  command->callback(
      [options, &run, &ranks] { run = [options, &ranks] { return localize_scenes(*options, ranks); }; });
}

}  // namespace perch::app
