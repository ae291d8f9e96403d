#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "evaluated_scenes.hpp"
#include "perch/localize/settings.hpp"

// What a benchmark has still to run, and how long that may take.
namespace perch::app {

/// One method on one scene. Its result lies in `folder`.
struct BenchmarkRun {
  std::size_t scene = 0;  ///< counts into the scenes of the benchmark
  LocalizationMethod method = LocalizationMethod::perch;
  std::filesystem::path folder;

  std::filesystem::path result() const { return folder / "result.json"; }
};

/// All runs, scene by scene. \param report the benchmark's folder: results lie in report/METHOD/SCENE.
std::vector<BenchmarkRun> benchmark_runs(const std::vector<EvaluatedScene>& scenes,
                                         const std::vector<LocalizationMethod>& methods,
                                         const std::filesystem::path& report);

/// True where the result is there, and no older than the scene file.
bool is_done(const BenchmarkRun& run, const EvaluatedScene& scene);

/// Makes sure that all results of a report are made with the same settings: writes these to
/// report/settings.yaml, or compares them with what an earlier run wrote there. Throws InputError naming the
/// first field that differs.
void keep_settings(const Settings& settings, const std::filesystem::path& report);

/// The time that runs take, by method: what is to come takes as long as the mean of what has been.
class RemainingTime {
 public:
  void took(LocalizationMethod method, double seconds);
  /// Seconds for so many runs of each method; empty as long as nothing has been run. A method that has not
  /// been run yet counts as the mean of the others. \param at_a_time how many runs are made beside each
  /// other, > 0.
  std::optional<double> of(const std::map<LocalizationMethod, std::size_t>& left,
                           std::size_t at_a_time) const;

 private:
  struct Sum {
    double seconds = 0.0;
    std::size_t runs = 0;
  };
  std::map<LocalizationMethod, Sum> sums_;
};

/// "12 s", "3 min", "2 h 5 min".
std::string duration(double seconds);

}  // namespace perch::app
