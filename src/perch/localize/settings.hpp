#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "perch/candidates/problem.hpp"
#include "perch/localize/finish_settings.hpp"
#include "perch/tree/monotone.hpp"

namespace perch {

/// What finds the objects.
enum class LocalizationMethod {
  perch,  ///< the search, with its bound
  bfwor,  ///< these have none: see docs/baselines.md
  ourcvfh,
  ppf
};

/// How the poses are made that the search ranges over.
enum class CandidateMode {
  fixed,   ///< every (model, grid pose) refined once, alone
  context  ///< refined again in each parent scene, the paper's way
};

enum class SearchMethod {
  branch_and_bound,  ///< over all collision-free scenes of fixed candidates
  focal_mha          ///< over the monotone scene generation tree
};

/// What bounds the cost of a state's goals from below, over fixed candidates.
enum class StateBound {
  none,       ///< h = 0, as in the paper: what is placed costs
  cover,      ///< and the points of I that the rest can't explain, see CoverBound
  lagrangian  ///< and the Lagrangian bound, which branch and bound needs
};

/// Everything that can be set. The command line, settings files and `--set` all go through settings_fields,
/// so that a default is written once, here and in the structs below.
struct Settings {
  LocalizationMethod localization = LocalizationMethod::perch;
  double w = 3.0;  ///< the answer costs at most w times the optimum
  CandidateMode mode = CandidateMode::fixed;
  std::optional<SearchMethod> method;  ///< see search_method()
  StateBound bound = StateBound::lagrangian;
  double time_limit = 60.0;                     ///< seconds of wall clock for the whole command
  std::size_t threads = 0;                      ///< 0 = as many as the machine has
  std::optional<std::uint64_t> max_expansions;  ///< stop the search after so many
  bool anytime = false;     ///< go on after the first solution, until it is proven optimal or time is up
  bool exhaustive = false;  ///< value every scene instead of searching; for small grids
  std::optional<double> bfwor_distance_limit;  ///< see BfworSettings::distance_limit, metres
  CandidateSettings candidates;
  MonotoneSettings tree;
  PolishSettings polish;
  AmbiguitySettings ambiguity;

  /// Branch and bound wherever it is possible, unless set.
  SearchMethod search_method() const {
    const bool possible = mode == CandidateMode::fixed && bound == StateBound::lagrangian;
    return method.value_or(possible ? SearchMethod::branch_and_bound : SearchMethod::focal_mha);
  }
  /// The factor at which the search may stop.
  double stopping_factor() const { return anytime ? 1.0 : w; }
  /// Throws InvalidSetting naming the field and the value.
  void check() const;
  /// What can be said only of all fields together. Throws InvalidSetting.
  void check_together() const;
};

/// One field as text.
struct SettingsField {
  std::string key;   ///< as in settings files and `--set`, e.g. "cost.delta"
  std::string help;  ///< what it is, with unit and range
  std::function<void(Settings&, const std::string&)>
      set;  ///< throws InvalidSetting where the text is no value for it
  std::function<std::string(const Settings&)> get;
};

/// Every field there is.
const std::vector<SettingsField>& settings_fields();

/// Sets one field from text. Throws InvalidSetting naming key, value and remedy, also for an unknown key.
void set_field(Settings& settings, const std::string& key, const std::string& value);

std::string name(LocalizationMethod method);
std::string name(CandidateMode mode);
std::string name(SearchMethod method);
std::string name(StateBound bound);
std::string name(RefineMethod method);
std::string name(MissingDepth missing_depth);
std::string name(ClutterPoints points);

}  // namespace perch
