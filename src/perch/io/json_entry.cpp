#include "perch/io/json_entry.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

using Json = nlohmann::json;

constexpr int deepest = 16;

/// Looks at a document while it is parsed.
class Watch {
 public:
  Watch(const std::string& file, const std::string& kind) : file_(file), kind_(kind) {}

  bool operator()(int depth, Json::parse_event_t event, const Json& value) {
    if (depth > deepest)
      throw InputError(fmt::format("{}: is nested deeper than {} levels; give a {}", file_, deepest, kind_));
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end) keys_.pop_back();
    if (event == Json::parse_event_t::key && !keys_.back().insert(value.get<std::string>()).second)
      throw InputError(fmt::format("{}: {}: stands there twice in one map; leave one", file_,
                                   one_line(value.get<std::string>())));
    return true;
  }

 private:
  const std::string &file_, &kind_;
  std::vector<std::set<std::string>> keys_;  ///< of the maps that are open
};

}  // namespace

JsonEntry JsonEntry::read(const std::filesystem::path& file, const JsonKind& kind) {
  const auto source = std::make_shared<const Source>(Source{shown(file), kind.name});
  const std::string bytes = read_file(file, kind.most_bytes);
  try {
    const auto root = std::make_shared<const Json>(Json::parse(bytes, Watch(source->file, source->kind)));
    return {root, root.get(), source, ""};
  } catch (const Json::exception& e) {
    throw InputError(fmt::format("{}: is no JSON ({}); write it again", source->file, one_line(e.what())));
  }
}

void JsonEntry::fail(const std::string& what_and_remedy) const {
  throw InputError(key_.empty() ? fmt::format("{}: {}", source_->file, what_and_remedy)
                                : fmt::format("{}: {}: {}", source_->file, key_, what_and_remedy));
}

std::string JsonEntry::value() const {
  if (json_->is_array()) return "a list";
  if (json_->is_object()) return "a map";
  return one_line(json_->dump(-1, ' ', false, Json::error_handler_t::replace));
}

bool JsonEntry::is_null() const {
  return json_->is_null();
}

bool JsonEntry::contains(std::string_view key) const {
  return json_->is_object() && json_->contains(std::string(key));
}

JsonEntry JsonEntry::operator[](std::string_view key) const {
  if (!json_->is_object()) fail(fmt::format("{} stands here; a map is expected", value()));
  const std::string path = key_.empty() ? std::string(key) : fmt::format("{}.{}", key_, key);
  const auto found = json_->find(std::string(key));
  if (found == json_->end())
    JsonEntry(root_, json_, source_, path).fail(fmt::format("is missing; give the whole {}", source_->kind));
  return {root_, &*found, source_, path};
}

double JsonEntry::number() const {
  if (!json_->is_number()) fail(fmt::format("{} is not a number; give one", value()));
  const double number = json_->get<double>();
  if (!std::isfinite(number)) fail(fmt::format("{} is not finite; give a number", value()));
  return number;
}

std::int64_t JsonEntry::integer() const {
  const double about = number();
  // Beyond 2^53 a floating-point value doesn't say which whole number it means.
  constexpr double largest = 9007199254740992.0;
  if (about != std::floor(about) || std::abs(about) >= largest)
    fail(fmt::format("{} is not a whole number below 2^53; give a count", value()));
  return static_cast<std::int64_t>(about);
}

bool JsonEntry::boolean() const {
  if (!json_->is_boolean()) fail(fmt::format("{} is neither true nor false; give one of them", value()));
  return json_->get<bool>();
}

std::string JsonEntry::text() const {
  if (!json_->is_string()) fail(fmt::format("{} is not text; give it in quotes", value()));
  return json_->get<std::string>();
}

std::vector<JsonEntry> JsonEntry::items() const {
  if (!json_->is_array()) fail(fmt::format("{} stands here; a list is expected", value()));
  std::vector<JsonEntry> out;
  for (std::size_t i = 0; i < json_->size(); ++i)
    out.push_back(JsonEntry(root_, &(*json_)[i], source_, fmt::format("{}[{}]", key_, i)));
  return out;
}

std::vector<double> JsonEntry::numbers(std::size_t count) const {
  const std::vector<JsonEntry> entries = items();
  if (entries.size() != count)
    fail(fmt::format("has {} values; give a list of {} numbers", entries.size(), count));
  std::vector<double> out;
  for (const JsonEntry& entry : entries) out.push_back(entry.number());
  return out;
}

std::vector<std::string> JsonEntry::keys() const {
  if (!json_->is_object()) fail(fmt::format("{} stands here; a map is expected", value()));
  std::vector<std::string> out;
  for (const auto& [key, unused] : json_->items()) out.push_back(key);
  return out;
}

std::string as_json_holds(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

}  // namespace perch
