#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace perch {

/// Throws InputError (one line: path, what is wrong, remedy) unless the path names a readable regular file of
/// 1 to `most_bytes` bytes. Returns its size in bytes.
std::uintmax_t check_file(const std::filesystem::path& path, std::uintmax_t most_bytes);

/// All bytes of a file; throws as check_file, or where reading fails.
std::string read_file(const std::filesystem::path& path, std::uintmax_t most_bytes);

}  // namespace perch
