#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace perch {

/// What a JSON file is read as.
struct JsonKind {
  std::string name = "result.json of perch";  ///< for messages
  std::uintmax_t most_bytes = 8U << 20U;      ///< larger files are refused
};

/// A value in a JSON file that knows the file and the key path that leads to it, so that every complaint is
/// one line `<file>: <key>: <value and what is wrong>; <remedy>`. All readers throw InputError. For use
/// inside io and eval.
class JsonEntry {
 public:
  /// The value in a file. Refuses repeated keys and values nested deeper than 16 levels.
  static JsonEntry read(const std::filesystem::path& file, const JsonKind& kind = {});

  [[noreturn]] void fail(const std::string& what_and_remedy) const;
  /// What stands here, for messages, in JSON; "a list" or "a map" for these.
  std::string value() const;

  /// The value of a key; throws where this is no map or the key is missing.
  JsonEntry operator[](std::string_view key) const;
  /// True where this is a map that has the key.
  bool contains(std::string_view key) const;
  bool is_null() const;

  double number() const;         ///< finite
  std::int64_t integer() const;  ///< whole, of either sign; 812.0 is
  bool boolean() const;
  std::string text() const;
  std::vector<JsonEntry> items() const;
  std::vector<double> numbers(std::size_t count) const;  ///< a list of so many
  std::vector<std::string> keys() const;                 ///< of a map, in the order of their bytes

 private:
  struct Source {
    std::string file;  ///< as messages show it
    std::string kind;
  };

  JsonEntry(std::shared_ptr<const nlohmann::json> root, const nlohmann::json* json,
            std::shared_ptr<const Source> source, std::string key)
      : root_(std::move(root)), json_(json), source_(std::move(source)), key_(std::move(key)) {}

  std::shared_ptr<const nlohmann::json> root_;
  const nlohmann::json* json_;
  std::shared_ptr<const Source> source_;
  std::string key_;
};

/// A text as a JSON file of ours can hold it: bytes that are not UTF-8 are written as U+FFFD.
std::string as_json_holds(const std::string& text);

}  // namespace perch
