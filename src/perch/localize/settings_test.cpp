#include "perch/localize/settings.hpp"

#include <gtest/gtest.h>

#include <set>

#include "perch/core/error.hpp"

namespace perch {
namespace {

TEST(Settings, EveryFieldReadsWhatItPrints) {
  std::set<std::string> keys;
  for (const SettingsField& field : settings_fields()) {
    SCOPED_TRACE(field.key);
    EXPECT_TRUE(keys.insert(field.key).second);
    EXPECT_FALSE(field.help.empty());
    Settings settings;
    const std::string text = field.get(settings);
    field.set(settings, text);
    EXPECT_EQ(field.get(settings), text);
    EXPECT_THROW(field.set(settings, "nonsense"), InvalidSetting);
    EXPECT_THROW(field.set(settings, ""), InvalidSetting);
    EXPECT_THROW(field.set(settings, "nan"), InvalidSetting);
  }
}

TEST(Settings, SetsByName) {
  Settings settings;
  set_field(settings, "cost.delta", "0.003");
  EXPECT_EQ(settings.candidates.cost.delta, 0.003);
  set_field(settings, "cost.missing_depth", "ignore");
  EXPECT_EQ(settings.candidates.cost.missing_depth, MissingDepth::ignore);
  set_field(settings, "grid.yaw_resolution_deg", "90");
  EXPECT_NEAR(settings.candidates.grid.yaw_resolution, 1.5707963, 1e-6);
  set_field(settings, "search.max_expansions", "12");
  EXPECT_EQ(settings.max_expansions, 12U);
  set_field(settings, "search.max_expansions", "auto");
  EXPECT_FALSE(settings.max_expansions);
}

TEST(Settings, RefusesWithKeyValueAndRemedy) {
  Settings settings;
  const auto message = [&](const std::string& key, const std::string& value) -> std::string {
    try {
      set_field(settings, key, value);
      settings.check();
    } catch (const InvalidSetting& error) {
      settings = {};
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("cost.dleta", "1").find("cost.delta"), std::string::npos)
      << "an unknown key lists the known ones";
  for (const auto& [key, value] : {std::pair{"cost.delta", "0"},
                                   {"cost.delta", "-1"},
                                   {"search.w", "0.5"},
                                   {"grid.resolution", "0"},
                                   {"search.time_limit", "0"},
                                   {"threads", "-3"},
                                   {"refine.rounds", "0"},
                                   {"cost.delta", "inf"},
                                   {"tree.pixel_tolerance", "-1"},
                                   {"polish.rounds", "-1"},
                                   {"polish.scenes", "0"},
                                   {"polish.trials", "0"},
                                   {"polish.largest_step", "0.0001"},
                                   {"polish.smallest_step", "0"},
                                   {"polish.turns", "-1"},
                                   {"polish.residual_weight", "-0.1"},
                                   {"ambiguity.distance", "0"},
                                   {"ambiguity.yaw_deg", "200"},
                                   {"ambiguity.descents", "-1"},
                                   {"ambiguity.trials", "-1"},
                                   {"search.method", "exhaustive"},
                                   {"search.anytime", "1"},
                                   {"search.exhaustive", "yes"}}) {
    const std::string text = message(key, value);
    EXPECT_FALSE(text.empty()) << key << '=' << value;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

// Each is fine alone; together the context leaves no fixed set to enumerate or to branch on.
TEST(Settings, ContextAllowsFocalMhaOnly) {
  Settings settings;
  EXPECT_EQ(settings.search_method(), SearchMethod::branch_and_bound);
  EXPECT_NO_THROW(settings.check_together());
  settings.exhaustive = true;
  EXPECT_NO_THROW(settings.check_together());
  set_field(settings, "search.candidates", "context");
  EXPECT_EQ(settings.search_method(), SearchMethod::focal_mha);
  EXPECT_THROW(settings.check_together(), InvalidSetting);
  settings.exhaustive = false;
  EXPECT_NO_THROW(settings.check_together());
  set_field(settings, "search.method", "branch-and-bound");
  EXPECT_THROW(settings.check_together(), InvalidSetting);
  set_field(settings, "search.method", "focal-mha");
  EXPECT_NO_THROW(settings.check_together());
  set_field(settings, "search.method", "auto");
  set_field(settings, "search.candidates", "fixed");
  EXPECT_EQ(settings.search_method(), SearchMethod::branch_and_bound);
}

}  // namespace
}  // namespace perch
