#include "perch/verify/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "command.hpp"
#include "perch/io/result_file.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/localize/prepare.hpp"

namespace perch::app {
namespace {

enum VerifyStatus { exit_holds = 0, exit_wrong = 1 };

struct VerifyOptions {
  std::string scene, result;
  bool quiet = false;
  SettingsOptions settings;
};

/// Width in columns of UTF-8 text.
std::size_t columns(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
}

void print_table(const Checks& checks) {
  std::size_t name = 0, reported = 8, recomputed = 10;
  for (const Check& check : checks) {
    name = std::max(name, columns(one_line(check.name)));
    reported = std::max(reported, columns(one_line(check.reported)));
    recomputed = std::max(recomputed, columns(one_line(check.recomputed)));
  }
  const auto cell = [](const std::string& text, std::size_t width) {
    const std::string shown = one_line(text);
    return shown + std::string(width - std::min(width, columns(shown)), ' ');
  };
  const auto line = [&](const std::string& a, const std::string& b, const std::string& c,
                        const char* verdict) {
    fmt::print("{}  {}  {}  {}\n", cell(a, name), cell(b, reported), cell(c, recomputed), verdict);
  };
  line("check", "reported", "recomputed", "verdict");
  for (const Check& check : checks)
    line(check.name, check.reported, check.recomputed, check.holds ? "ok" : "WRONG");
}

int verify_result(const VerifyOptions& options) {
  Scene scene = read_scene(options.scene);
  const ReportedResult result = read_result(options.result, scene);
  const Settings stated =
      blaming(options.result + ": guarantee", [&] { return stated_settings(result.guarantee); });
  const Settings settings = options.settings.read(stated);
  scene = blaming(options.scene, [&] { return prepare(std::move(scene), settings, SerialExecutor()); });
  const Checks checks = blaming(options.scene, [&] { return verify(scene, result, settings); });
  const auto wrong =
      std::count_if(checks.begin(), checks.end(), [](const Check& check) { return !check.holds; });
  if (!options.quiet) {
    print_table(checks);
    if (wrong == 0)
      fmt::print("all {} checks hold\n", checks.size());
    else
      fmt::print("{} of {} checks are WRONG\n", wrong, checks.size());
  }
  return wrong == 0 ? exit_holds : exit_wrong;
}

}  // namespace

void add_verify(CLI::App& app, Run& run) {
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command =
      app.add_subcommand("verify", "check a result.json by other means than those that made it");
  command->footer(
      "What isn't given is taken from the result. Exit status: 0 all checks hold; 1 one doesn't; 2 bad usage "
      "or "
      "input.");
  command->add_option("scene", options->scene, "scene file (YAML)")->required();
  command->add_option("result", options->result, "result.json of that scene")->required();
  command->add_flag("-q,--quiet", options->quiet, "no table; the exit status says it");
  options->settings.add_to(*command, {{"--delta", "cost.delta"}});
  command->callback([options, &run] { run = [options] { return verify_result(*options); }; });
}

}  // namespace perch::app
