#include <fmt/format.h>

#include "command.hpp"
#include "perch/core/error.hpp"
#include "perch/io/settings_file.hpp"

namespace perch::app {
namespace {

std::string help_of(const std::string& key) {
  const Settings defaults;
  for (const SettingsField& field : settings_fields())
    if (field.key == key) return fmt::format("{} [{}]", field.help, field.get(defaults));
  return {};
}

std::string all_fields() {
  const Settings defaults;
  std::string text = "set one field, key=value. Fields:";
  for (const SettingsField& field : settings_fields())
    text += fmt::format("\n{} [{}]: {}", field.key, field.get(defaults), field.help);
  return text;
}

}  // namespace

void SettingsOptions::add_to(CLI::App& command,
                             const std::vector<std::pair<std::string, std::string>>& flags) {
  command.add_option("--settings", file_, "YAML file of settings fields");
  command.add_option("--set", assignments_, all_fields())->allow_extra_args(false);
  flags_ = flags;
  values_.resize(flags.size());
  for (std::size_t i = 0; i < flags.size(); ++i)
    command.add_option(flags[i].first, values_[i], help_of(flags[i].second));
}

Settings SettingsOptions::read(const Settings& base) const {
  Settings settings = base;
  if (file_) {
    read_settings(*file_, settings);
    blaming(*file_, [&] { settings.check(); });
  }
  for (std::size_t i = 0; i < flags_.size(); ++i)
    if (values_[i])
      blaming(flags_[i].first, [&] {
        set_field(settings, flags_[i].second, *values_[i]);
        settings.check();
      });
  for (const std::string& assignment : assignments_) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos)
      throw InvalidSetting(fmt::format("--set {}: give key=value, e.g. --set cost.delta=0.005", assignment));
    set_field(settings, assignment.substr(0, equals), assignment.substr(equals + 1));
  }
  settings.check();
  return settings;
}

}  // namespace perch::app
