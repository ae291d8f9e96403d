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
                                   {"search.method", "branch-and-bound"}}) {
    const std::string text = message(key, value);
    EXPECT_FALSE(text.empty()) << key << '=' << value;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace perch
