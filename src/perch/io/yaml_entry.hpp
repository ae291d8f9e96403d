#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace perch {

class YamlFields;

/// A value in a YAML (or JSON) file that knows the file and the key path that leads to it, so that every
/// complaint is one line `<file>: <key>: <value and what is wrong>; <remedy>`. All readers throw InputError.
/// For use inside io.
class YamlEntry {
 public:
  /// The root of the one document in a file of at most 4 MB.
  static YamlEntry read(const std::filesystem::path& file);

  [[noreturn]] void fail(const std::string& what_and_remedy) const;
  /// As fail, but about a key of this map, which may be missing.
  [[noreturn]] void fail_at(std::string_view child, const std::string& what_and_remedy) const;
  /// The key path, e.g. `objects[2].model`; empty at the root.
  const std::string& key() const { return key_; }
  /// What stands here, for messages: the text in quotes, "a list", "a map" or "nothing".
  std::string value() const;

  /// A finite number. \param meaning unit or role for the message, e.g. "metres".
  double number(std::string_view meaning) const;
  /// A whole number in [low, high].
  int integer(int low, int high) const;
  /// Non-empty text; a plain number is taken as the text that stands in the file.
  std::string text() const;
  /// true or false, unquoted.
  bool boolean() const;
  bool is_map() const { return node_.IsMap(); }
  bool is_scalar() const { return node_.IsScalar(); }
  bool is_quoted() const { return node_.IsScalar() && node_.Tag() == "!"; }

  /// The elements of a list. \param of what they are, for the message.
  std::vector<YamlEntry> items(std::string_view of) const;
  /// The pairs of a map in the file's order; a repeated key is an error.
  std::vector<std::pair<std::string, YamlEntry>> pairs() const;
  /// A map that may hold the `known` keys only.
  YamlFields fields(std::vector<std::string> known) const;

 private:
  YamlEntry(YAML::Node node, std::shared_ptr<const std::string> file, std::string key)
      : node_(std::move(node)), file_(std::move(file)), key_(std::move(key)) {}
  std::string key_of(std::string_view child) const;

  YAML::Node node_;
  std::shared_ptr<const std::string> file_;  ///< as messages show it
  std::string key_;
};

/// The entries of a map whose keys have been checked.
class YamlFields {
 public:
  explicit YamlFields(YamlEntry owner) : owner_(std::move(owner)) {}
  void put(std::string key, YamlEntry entry) { entries_.emplace(std::move(key), std::move(entry)); }

  /// Throws where the key is missing; the remedy says what to give.
  const YamlEntry& required(const std::string& key, std::string_view remedy) const;
  /// nullptr where the key is missing.
  const YamlEntry* optional(const std::string& key) const;

 private:
  YamlEntry owner_;
  std::map<std::string, YamlEntry> entries_;
};

}  // namespace perch
