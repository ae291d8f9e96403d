#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "perch/eval/record.hpp"

namespace perch {

constexpr double degrees(double value) {
  return value / 180.0 * std::numbers::pi;
}

/// The paper's thresholds, metres and degrees; 180 takes any yaw.
inline constexpr std::array<double, 3> paper_translations{0.01, 0.05, 0.10};
inline constexpr std::array<double, 4> paper_yaws_deg{5.0, 10.0, 22.5, 180.0};

/// What counts as right where one threshold must serve: verdicts, and recall against visibility.
inline constexpr Threshold right_threshold{0.01, degrees(10.0)};

/// How many objects there are, and what became of them; those not within and not ambiguous are missed.
struct Tally {
  std::size_t objects = 0, within = 0, ambiguous = 0;

  void add(Verdict verdict);
  std::size_t missed() const { return objects - within - ambiguous; }
  friend bool operator==(const Tally&, const Tally&) = default;
};

/// Objects of which a fraction from `low` to below `high` is visible (to `high` itself where that is 1), by
/// right_threshold.
struct VisibilityBin {
  double low = 0.0, high = 0.0;
  Tally tally;
};

/// Shares in [0, 1] of all objects.
struct Recalls {
  double add = 0.0;       ///< ADD below 10 % of the diameter
  double add_s = 0.0;     ///< ADD-S below 10 % of the diameter
  double add_or_s = 0.0;  ///< ADD(-S): ADD-S for symmetric models, ADD for others
  double ar_vsd = 0.0;    ///< mean over tau and theta of the share with VSD(tau) < theta
  double ar_mssd = 0.0;   ///< mean over thresholds of 5 % to 50 % of the diameter
  double ar_mspd = 0.0;   ///< mean over thresholds of 5 to 50 pixels of an image 640 wide
  /// BOP's average recall.
  double ar() const { return (ar_vsd + ar_mssd + ar_mspd) / 3.0; }
};

/// What became of all objects of all scenes under one method.
struct MethodSummary {
  std::string method;
  std::size_t scenes = 0;
  std::vector<std::string> without_result;  ///< names of scenes
  std::size_t not_found = 0;                ///< objects that no estimate stands for
  std::size_t surplus = 0;                  ///< objects placed that the truth lacks
  std::array<std::array<Tally, paper_yaws_deg.size()>, paper_translations.size()> thresholds{};
  Tally right;  ///< by right_threshold
  Recalls recalls;
  std::vector<VisibilityBin> visibility;               ///< five of a width of 0.2, ascending
  std::optional<double> mean_seconds, median_seconds;  ///< over the scenes with a result
  std::optional<double> median_rendered;               ///< hypotheses, over the same
  std::optional<double> mean_expanded;                 ///< states or nodes of the search, over the same
  std::size_t bounded = 0;                             ///< scenes with a proven suboptimality bound
  std::optional<double> median_bound, largest_bound;   ///< over these
};

MethodSummary summarize(const MethodRecord& record);

/// The 95 % interval of a share of which `successes` of `trials` > 0 were seen (Wilson 1927).
std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials);

}  // namespace perch
