#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "perch/io/format_fault.hpp"
#include "perch/io/message.hpp"

namespace perch {

/// The lines of a text, one after another, whichever way they end.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  std::optional<std::string_view> next() {
    if (rest_.empty()) return std::nullopt;
    const std::size_t end = rest_.find('\n');
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

/// Takes the next word off the front of a line.
inline std::optional<std::string_view> next_word(std::string_view& line) {
  constexpr std::string_view blank = " \t\r";
  const std::size_t begin = line.find_first_not_of(blank);
  if (begin == std::string_view::npos) return std::nullopt;
  line.remove_prefix(begin);
  const std::size_t end = std::min(line.find_first_of(blank), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

/// Takes the next word off the front of a line as a number; not finite where it is beyond double.
inline double next_number(std::string_view& line) {
  const auto word = next_word(line);
  if (!word) throw FormatFault{"has a line with too few values"};
  std::string_view text = *word;
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument)
    throw FormatFault{fmt::format("has \"{}\" where a number is expected", one_line(*word))};
  if (error != std::errc{})  // too large, or so small that it is zero
    return text.find("e-") == std::string_view::npos && text.find("E-") == std::string_view::npos
               ? std::numeric_limits<double>::infinity()
               : 0.0;
  return value;
}

}  // namespace perch
