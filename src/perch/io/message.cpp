#include "perch/io/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace perch {
namespace {

/// Levenshtein's distance: single-character edits between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({substitute, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string one_line(std::string_view text) {
  constexpr std::size_t longest = 200;
  std::string out;
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '\n')
      out += "\\n";
    else if (byte < 0x20 || byte == 0x7f)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += c;
  }
  if (text.size() > longest) out += "...";
  return out;
}

std::string shown(const std::filesystem::path& path) {
  std::string out;
  const std::string text = path.string();
  // A path is never cut: its end says the most.
  for (std::size_t i = 0; i < text.size(); i += 100)
    out += one_line(std::string_view(text).substr(i, std::min<std::size_t>(100, text.size() - i)));
  return out;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t most_named = 20;
  std::string out;
  if (!known.empty() && word.size() <= 100) {
    const auto distance = [&](const std::string& k) { return edit_distance(word, k); };
    const auto nearest = std::min_element(
        known.begin(), known.end(), [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    if (distance(*nearest) <= std::max<std::size_t>(1, word.size() / 2))
      out = fmt::format("did you mean {}? ", one_line(*nearest));
  }
  out += "known: ";
  for (std::size_t i = 0; i < std::min(known.size(), most_named); ++i)
    out += (i ? ", " : "") + one_line(known[i]);
  if (known.size() > most_named) out += fmt::format(" and {} more", known.size() - most_named);
  return out;
}

}  // namespace perch
