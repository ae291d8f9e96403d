#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/localize/settings.hpp"

namespace perch::app {

class Ranks;

/// Exit statuses of the command line.
enum ExitStatus { exit_solved = 0, exit_infeasible = 1, exit_bad_input = 2, exit_time_limit = 3 };

/// The options that set fields of Settings: flags, `--settings FILE` and `--set key=value`. The file comes
/// first, then the flags, then `--set`.
class SettingsOptions {
 public:
  /// Adds `--settings`, `--set` and a flag for each (flag, field) pair.
  void add_to(CLI::App& command, const std::vector<std::pair<std::string, std::string>>& flags);
  /// The settings after all options, those not given as in `base`; throws InputError.
  Settings read(const Settings& base = {}) const;

 private:
  std::optional<std::string> file_;
  std::vector<std::string> assignments_;
  std::vector<std::pair<std::string, std::string>> flags_;  // (flag, field)
  std::vector<std::optional<std::string>> values_;          // of the flags, where given
};

/// Does the work; where it throws InputError, puts what is to blame, a file or a flag, before the message.
template <typename Work>
auto blaming(const std::string& name, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", shown(name), error.what()));
  }
}

/// Each adds its subcommand; the function it sets `run` to does the work and returns the exit status.
using Run = std::function<int()>;
void add_localize(CLI::App& app, Run& run, const Ranks& ranks);
void add_score(CLI::App& app, Run& run);
void add_evaluate(CLI::App& app, Run& run);
void add_benchmark(CLI::App& app, Run& run, const Ranks& ranks);
void add_inspect(CLI::App& app, Run& run);
void add_simulate(CLI::App& app, Run& run);
void add_verify(CLI::App& app, Run& run);  // where it is built

}  // namespace perch::app
