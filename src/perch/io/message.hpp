#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace perch {

/// The text with control characters written as escapes, so that a message stays on one line whatever a file
/// holds; cut after 200 bytes.
std::string one_line(std::string_view text);

/// The path as a message shows it.
std::string shown(const std::filesystem::path& path);

/// "known: a, b, c", led by "did you mean b? " where one of the words is close to `word`.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

}  // namespace perch
