#include "benchmark_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/message.hpp"
#include "perch/io/read_file.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t most_bytes = 1 << 20;  // of settings

/// All fields but the method, a line each, as --settings reads them.
std::string settings_text(const Settings& settings) {
  std::string text = "# Made by perch benchmark: the settings of every result in this folder.\n";
  for (const SettingsField& field : settings_fields())
    if (field.key != "method") text += fmt::format("{}: {}\n", field.key, field.get(settings));
  return text;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

}  // namespace

std::vector<BenchmarkRun> benchmark_runs(const std::vector<EvaluatedScene>& scenes,
                                         const std::vector<LocalizationMethod>& methods,
                                         const fs::path& report) {
  std::vector<BenchmarkRun> runs;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const LocalizationMethod method : methods)
      runs.push_back({i, method, report / name(method) / scenes[i].name});
  return runs;
}

bool is_done(const BenchmarkRun& run, const EvaluatedScene& scene) {
  std::error_code error;
  const auto made = fs::last_write_time(run.result(), error);
  if (error) return false;
  const auto changed = fs::last_write_time(scene.file, error);
  return !error && made >= changed;
}

void keep_settings(const Settings& settings, const fs::path& report) {
  const fs::path file = report / "settings.yaml";
  const std::string now = settings_text(settings);
  std::error_code error;
  if (!fs::exists(file, error)) {
    write_atomically(file, now);
    return;
  }
  const std::vector<std::string> before = lines_of(read_file(file, most_bytes)), after = lines_of(now);
  for (std::size_t i = 0; i < std::max(before.size(), after.size()); ++i) {
    const std::string was = i < before.size() ? before[i] : "nothing",
                      is = i < after.size() ? after[i] : "nothing";
    if (was == is) continue;
    throw InputError(fmt::format(
        "{}: the results there were made with `{}`, now it is `{}`; set what was set before, or name another "
        "folder",
        shown(file), one_line(was), one_line(is)));
  }
}

void RemainingTime::took(LocalizationMethod method, double seconds) {
  sums_[method].seconds += seconds;
  ++sums_[method].runs;
}

std::optional<double> RemainingTime::of(const std::map<LocalizationMethod, std::size_t>& left,
                                        std::size_t at_a_time) const {
  Sum all;
  for (const auto& [method, sum] : sums_) {
    all.seconds += sum.seconds;
    all.runs += sum.runs;
  }
  if (all.runs == 0) return std::nullopt;
  double seconds = 0.0;
  std::size_t runs_left = 0;
  for (const auto& [method, runs] : left) {
    const auto known = sums_.find(method);
    const Sum& sum = known == sums_.end() ? all : known->second;
    seconds += static_cast<double>(runs) * sum.seconds / static_cast<double>(sum.runs);
    runs_left += runs;
  }
  return seconds / static_cast<double>(std::max<std::size_t>(1, std::min(at_a_time, runs_left)));
}

std::string duration(double seconds) {
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  const long minutes = (whole + 30) / 60;
  if (minutes < 60) return fmt::format("{} min", minutes);
  return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

}  // namespace perch::app
