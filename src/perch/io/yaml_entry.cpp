#include "perch/io/yaml_entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

constexpr std::uintmax_t largest_yaml_file = std::uintmax_t{4} << 20;

/// The number that the whole text spells, not finite where it spells infinity, NaN or something beyond
/// double.
std::optional<double> parse_number(std::string_view text) {
  for (const std::string_view word : {".inf", "+.inf", "-.inf", ".Inf", ".INF", ".nan", ".NaN", ".NAN"})
    if (text == word) return std::nan("");
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || text.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::nan("");
  if (error != std::errc{}) return std::nullopt;
  return value;
}

}  // namespace

YamlEntry YamlEntry::read(const std::filesystem::path& file) {
  const std::string bytes = read_file(file, largest_yaml_file);
  auto name = std::make_shared<const std::string>(shown(file));
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}; write it as one YAML or JSON document", *name, what));
  };
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(bytes);
  } catch (const YAML::Exception& e) {
    fail(fmt::format("line {}, column {}: is not YAML or is cut short ({})", e.mark.line + 1,
                     e.mark.column + 1, one_line(e.msg)));
  } catch (const std::exception& e) {
    fail(fmt::format("is not YAML ({})", one_line(e.what())));
  }
  if (documents.empty()) fail("holds no YAML document");
  if (documents.size() > 1) fail(fmt::format("holds {} YAML documents, not one", documents.size()));
  return {documents.front(), std::move(name), {}};
}

std::string YamlEntry::key_of(std::string_view child) const {
  return key_.empty() ? one_line(child) : fmt::format("{}.{}", key_, one_line(child));
}

void YamlEntry::fail(const std::string& what_and_remedy) const {
  throw InputError(key_.empty() ? fmt::format("{}: {}", *file_, what_and_remedy)
                                : fmt::format("{}: {}: {}", *file_, key_, what_and_remedy));
}

void YamlEntry::fail_at(std::string_view child, const std::string& what_and_remedy) const {
  throw InputError(fmt::format("{}: {}: {}", *file_, key_of(child), what_and_remedy));
}

std::string YamlEntry::value() const {
  if (node_.IsScalar()) return fmt::format("\"{}\"", one_line(node_.Scalar()));
  if (node_.IsSequence()) return "a list";
  if (node_.IsMap()) return "a map";
  return "nothing";
}

double YamlEntry::number(std::string_view meaning) const {
  const auto parsed = node_.IsScalar() && !is_quoted() ? parse_number(node_.Scalar()) : std::nullopt;
  if (!parsed) fail(fmt::format("{} is not a number; give a plain number ({})", value(), meaning));
  if (!std::isfinite(*parsed))
    fail(fmt::format("{} is not finite; give a finite number ({})", value(), meaning));
  return *parsed;
}

int YamlEntry::integer(int low, int high) const {
  const auto parsed = node_.IsScalar() && !is_quoted() ? parse_number(node_.Scalar()) : std::nullopt;
  if (!parsed || *parsed != std::floor(*parsed) || *parsed < low || *parsed > high)
    fail(fmt::format("{} is not a whole number from {} to {}; give one", value(), low, high));
  return static_cast<int>(*parsed);
}

bool YamlEntry::boolean() const {
  const bool is_true = node_.IsScalar() && node_.Scalar() == "true";
  if (is_quoted() || !(is_true || (node_.IsScalar() && node_.Scalar() == "false")))
    fail(fmt::format("{} is neither true nor false; give one of these", value()));
  return is_true;
}

std::string YamlEntry::text() const {
  if (!node_.IsScalar()) fail(fmt::format("{} stands where text is expected; give a name", value()));
  if (node_.Scalar().empty()) fail("is empty; give a name");
  return node_.Scalar();
}

std::vector<YamlEntry> YamlEntry::items(std::string_view of) const {
  if (!node_.IsSequence())
    fail(fmt::format("{} stands where a list is expected; give a list of {}", value(), of));
  std::vector<YamlEntry> out;
  out.reserve(node_.size());
  for (const YAML::Node& item : node_) out.push_back({item, file_, fmt::format("{}[{}]", key_, out.size())});
  return out;
}

std::vector<std::pair<std::string, YamlEntry>> YamlEntry::pairs() const {
  if (!node_.IsMap())
    fail(fmt::format("{} stands where a map is expected; give \"key: value\" pairs", value()));
  std::vector<std::pair<std::string, YamlEntry>> out;
  std::set<std::string> seen;
  for (const auto& pair : node_) {
    if (!pair.first.IsScalar()) fail("a key is not plain text; give \"key: value\" pairs");
    const std::string& name = pair.first.Scalar();
    const YamlEntry entry(pair.second, file_, key_of(name));
    if (!seen.insert(name).second) entry.fail("the key is given twice; keep one");
    out.emplace_back(name, entry);
  }
  return out;
}

YamlFields YamlEntry::fields(std::vector<std::string> known) const {
  YamlFields out(*this);
  for (auto& [name, entry] : pairs()) {
    if (std::find(known.begin(), known.end(), name) == known.end())
      entry.fail("unknown key; " + did_you_mean(name, known));
    out.put(name, entry);
  }
  return out;
}

const YamlEntry& YamlFields::required(const std::string& key, std::string_view remedy) const {
  const YamlEntry* entry = optional(key);
  if (!entry) owner_.fail_at(key, fmt::format("is missing; {}", remedy));
  return *entry;
}

const YamlEntry* YamlFields::optional(const std::string& key) const {
  const auto it = entries_.find(key);
  return it == entries_.end() ? nullptr : &it->second;
}

}  // namespace perch
