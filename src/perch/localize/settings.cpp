#include "perch/localize/settings.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>

#include "perch/core/error.hpp"

namespace perch {
namespace {

template <typename T>
struct Names;  // of an enumeration's values, in order

template <>
struct Names<LocalizationMethod> {
  static inline const std::vector<std::string> all{"perch", "bfwor", "ourcvfh", "ppf"};
};
template <>
struct Names<CandidateMode> {
  static inline const std::vector<std::string> all{"fixed", "context"};
};
template <>
struct Names<SearchMethod> {
  static inline const std::vector<std::string> all{"branch-and-bound", "focal-mha"};
};
template <>
struct Names<StateBound> {
  static inline const std::vector<std::string> all{"none", "cover", "lagrangian"};
};
template <>
struct Names<RefineMethod> {
  static inline const std::vector<std::string> all{"none", "icp"};
};
template <>
struct Names<ClutterPoints> {
  static inline const std::vector<std::string> all{"charge", "ignore"};
};
template <>
struct Names<MissingDepth> {
  static inline const std::vector<std::string> all{"unexplained", "ignore"};
};

[[noreturn]] void fail(const std::string& key, const std::string& text, const std::string& wanted) {
  throw InvalidSetting(fmt::format("{}: '{}' is not {}", key, text, wanted));
}

template <typename T>
T parse(const std::string& key, const std::string& text) {
  if constexpr (std::is_enum_v<T>) {
    const auto& all = Names<T>::all;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (all[i] == text) return static_cast<T>(i);
    fail(key, text, fmt::format("one of {}", fmt::join(all, ", ")));
  } else if constexpr (std::is_same_v<T, bool>) {
    if (text != "true" && text != "false") fail(key, text, "true or false");
    return text == "true";
  } else {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end)
      fail(key, text, std::is_floating_point_v<T> ? "a number" : "a whole number in range");
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(value)) fail(key, text, "a finite number");
    return value;
  }
}

template <typename T>
std::string print(const T& value) {
  if constexpr (std::is_enum_v<T>)
    return Names<T>::all[static_cast<std::size_t>(value)];
  else
    return fmt::format("{}", value);
}

template <typename T>
using Member = T& (*)(Settings&);

/// Written as it is held.
template <typename T>
struct Plain {
  static T parse(const std::string& key, const std::string& text) { return perch::parse<T>(key, text); }
  static std::string print(const T& value) { return perch::print(value); }
};

/// May be left unset; "auto" unsets it.
template <typename T>
struct OrAuto {
  static std::optional<T> parse(const std::string& key, const std::string& text) {
    return text == "auto" ? std::nullopt : std::optional(perch::parse<T>(key, text));
  }
  static std::string print(const std::optional<T>& value) { return value ? perch::print(*value) : "auto"; }
};

/// Written in degrees and held in radians.
struct Degrees {
  static constexpr double degree = std::numbers::pi / 180.0;
  static double parse(const std::string& key, const std::string& text) {
    return perch::parse<double>(key, text) * degree;
  }
  static std::string print(double value) { return perch::print(value / degree); }
};

template <typename Format, typename T>
SettingsField field_as(std::string key, std::string help, Member<T> member) {
  return {key, std::move(help),
          [=](Settings& s, const std::string& text) { member(s) = Format::parse(key, text); },
          [=](const Settings& s) { return Format::print(member(const_cast<Settings&>(s))); }};
}

template <typename T>
SettingsField field(std::string key, std::string help, Member<T> member) {
  return field_as<Plain<T>>(std::move(key), std::move(help), member);
}
template <typename T>
SettingsField optional_field(std::string key, std::string help, Member<std::optional<T>> member) {
  return field_as<OrAuto<T>>(std::move(key), std::move(help), member);
}
SettingsField degrees_field(std::string key, std::string help, Member<double> member) {
  return field_as<Degrees>(std::move(key), std::move(help), member);
}

#define PERCH_FIELD(member)    \
  +[](Settings & s) -> auto& { \
    return s.member;           \
  }

std::vector<SettingsField> make_fields() {
  return {
      field("method", "perch, or one of the baselines bfwor, ourcvfh and ppf, which have no bound",
            PERCH_FIELD(localization)),
      field("search.w", "suboptimality factor, >= 1", PERCH_FIELD(w)),
      optional_field("search.method",
                     "branch-and-bound or focal-mha; auto: the first for fixed candidates, the second in "
                     "context",
                     PERCH_FIELD(method)),
      field("search.bound", "none, cover or lagrangian: what bounds a state's goals, over fixed candidates",
            PERCH_FIELD(bound)),
      field("search.candidates", "fixed: refined alone; context: refined in each parent scene",
            PERCH_FIELD(mode)),
      field("search.time_limit", "seconds of wall clock for the whole command, > 0", PERCH_FIELD(time_limit)),
      optional_field("search.max_expansions", "stop after so many expansions; auto: no limit",
                     PERCH_FIELD(max_expansions)),
      field("search.anytime", "go on after the first solution: true or false", PERCH_FIELD(anytime)),
      field("search.exhaustive", "value every scene instead of searching: true or false",
            PERCH_FIELD(exhaustive)),
      optional_field(
          "bfwor.distance_limit",
          "what a model point's distance counts at most in ICP's fitness, metres; auto: no limit, as in "
          "the paper",
          PERCH_FIELD(bfwor_distance_limit)),
      field("threads", "0: as many as the machine has", PERCH_FIELD(threads)),
      field("grid.resolution", "step in x and y, metres", PERCH_FIELD(candidates.grid.resolution)),
      degrees_field("grid.yaw_resolution_deg", "step in yaw, degrees",
                    PERCH_FIELD(candidates.grid.yaw_resolution)),
      field("grid.max_poses", "refuse a larger grid", PERCH_FIELD(candidates.grid.max_poses)),
      field("cost.delta", "sensor resolution, metres", PERCH_FIELD(candidates.cost.delta)),
      field("cost.missing_depth", "rendered points without a reading: unexplained or ignore",
            PERCH_FIELD(candidates.cost.missing_depth)),
      field(
          "cost.clutter_weight",
          "of a rendered point hidden by what no model describes, in scenes with clutter; in 64ths, > 0 to 1",
          PERCH_FIELD(candidates.cost.clutter_weight)),
      field("cost.clutter_points", "unexplained points of I in scenes with clutter: charge or ignore",
            PERCH_FIELD(candidates.cost.clutter_points)),
      field("refine.method", "icp or none", PERCH_FIELD(candidates.refine.method)),
      optional_field("refine.reach", "farthest correspondence, metres; auto: half the grid step",
                     PERCH_FIELD(candidates.refine.reach)),
      field("refine.rounds", "times an object is looked at anew and aligned",
            PERCH_FIELD(candidates.refine.rounds)),
      field("refine.iterations", "of one round, at most", PERCH_FIELD(candidates.refine.iterations)),
      field("refine.samples", "points of the surface used in a round, about",
            PERCH_FIELD(candidates.refine.samples)),
      field("refine.least_matched",
            "share of the samples that must find an observed point, or the pose stays",
            PERCH_FIELD(candidates.refine.least_matched)),
      field("refine.robust_scale", "residual of half weight, metres",
            PERCH_FIELD(candidates.refine.robust_scale)),
      field("refine.occlusion", "a point this far behind the observed one is taken as hidden, metres",
            PERCH_FIELD(candidates.refine.occlusion)),
      field("collision.penetration", "how far objects may enter each other, metres",
            PERCH_FIELD(candidates.collision.penetration)),
      field("collision.overlap", "share of a solid that may lie inside another",
            PERCH_FIELD(candidates.collision.overlap)),
      field("tree.depth_tolerance", "a successor may cover rendered pixels by this depth, metres",
            PERCH_FIELD(tree.depth_tolerance)),
      field("tree.pixel_tolerance", "and this many by any depth", PERCH_FIELD(tree.pixel_tolerance)),
      field("polish.rounds", "times that every object of the answer is moved, at most; 0: no polish",
            PERCH_FIELD(polish.rounds)),
      field("polish.scenes", "near-optimal scenes that are polished, at most", PERCH_FIELD(polish.scenes)),
      field("polish.trials", "poses valued for each object of a scene, at most", PERCH_FIELD(polish.trials)),
      field("polish.largest_step", "first step, metres", PERCH_FIELD(polish.descent.largest_step)),
      field("polish.smallest_step", "last step, metres", PERCH_FIELD(polish.descent.smallest_step)),
      field("polish.turns", "other yaws, evenly spaced, that ICP starts from",
            PERCH_FIELD(polish.descent.turns)),
      field("polish.residual_weight", "what distances below delta count beside J; 0: J alone",
            PERCH_FIELD(polish.descent.residual_weight)),
      field("ambiguity.distance", "a runner-up lies farther from the answer than this, metres",
            PERCH_FIELD(ambiguity.distance)),
      degrees_field("ambiguity.yaw_deg", "or is turned by more than this, degrees",
                    PERCH_FIELD(ambiguity.yaw)),
      field("ambiguity.descents", "how many of the best other poses are moved downhill",
            PERCH_FIELD(ambiguity.descents)),
      field("ambiguity.trials", "poses valued for each object to judge it, at most; 0: no confidence",
            PERCH_FIELD(ambiguity.trials)),
  };
}

#undef PERCH_FIELD

}  // namespace

void Settings::check() const {
  if (!std::isfinite(w) || w < 1.0)
    throw InvalidSetting(fmt::format("search.w is {}; it must be finite and at least 1", w));
  if (!std::isfinite(time_limit) || time_limit <= 0.0)
    throw InvalidSetting(
        fmt::format("search.time_limit is {}; it must be finite and > 0 (seconds)", time_limit));
  if (bfwor_distance_limit && !(*bfwor_distance_limit > 0.0 && *bfwor_distance_limit <= 100.0))
    throw InvalidSetting(fmt::format("bfwor.distance_limit is {}; it must lie above 0 and up to 100 metres",
                                     *bfwor_distance_limit));
  if (threads > 1024) throw InvalidSetting(fmt::format("threads is {}; it must be at most 1024", threads));
  candidates.check();
  tree.check();
  polish.check();
  ambiguity.check();
}

namespace {

/// A baseline has no search: what is set of it would be left aside without a word.
void check_baseline(const Settings& settings) {
  const Settings defaults;
  for (const SettingsField& field : settings_fields())
    if (field.key.starts_with("search.") && field.key != "search.time_limit" &&
        field.get(settings) != field.get(defaults))
      throw InvalidSetting(
          fmt::format("{} is {}, which {} has no use for; leave it out, or use --method perch", field.key,
                      field.get(settings), name(settings.localization)));
}

}  // namespace

void Settings::check_together() const {
  if (localization != LocalizationMethod::perch) return check_baseline(*this);
  if (search_method() == SearchMethod::branch_and_bound && bound != StateBound::lagrangian)
    throw InvalidSetting(fmt::format(
        "search.bound is {}, but branch-and-bound needs lagrangian; use --search focal-mha", name(bound)));
  if (mode != CandidateMode::context) return;
  if (search_method() == SearchMethod::branch_and_bound)
    throw InvalidSetting(
        "search.method is branch-and-bound, which needs fixed candidates; use --candidates fixed or --search "
        "focal-mha");
  if (exhaustive)
    throw InvalidSetting("search.exhaustive is true, which needs fixed candidates; use --candidates fixed");
}

const std::vector<SettingsField>& settings_fields() {
  static const std::vector<SettingsField> fields = make_fields();
  return fields;
}

void set_field(Settings& settings, const std::string& key, const std::string& value) {
  std::vector<std::string> known;
  for (const SettingsField& field : settings_fields()) {
    if (field.key == key) return field.set(settings, value);
    known.push_back(field.key);
  }
  throw InvalidSetting(fmt::format("{}: unknown setting; known are {}", key, fmt::join(known, ", ")));
}

std::string name(LocalizationMethod method) {
  return print(method);
}
std::string name(CandidateMode mode) {
  return print(mode);
}
std::string name(SearchMethod method) {
  return print(method);
}
std::string name(StateBound bound) {
  return print(bound);
}
std::string name(RefineMethod method) {
  return print(method);
}
std::string name(ClutterPoints points) {
  return print(points);
}
std::string name(MissingDepth missing_depth) {
  return print(missing_depth);
}

}  // namespace perch
