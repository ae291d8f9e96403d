#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "perch/baselines/cloud_descriptors.hpp"

namespace perch {

/// FNV-1a, 64 bits (Fowler, Noll and Vo), over the bytes of what is added: tells files and inputs apart, and
/// finds damage. No protection from those who mean harm.
class Fingerprint {
 public:
  void add(std::span<const std::byte> bytes) {
    for (const std::byte b : bytes) value_ = (value_ ^ static_cast<std::uint64_t>(b)) * 0x100000001b3ULL;
  }
  template <typename T>
  void add_value(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    add(std::as_bytes(std::span(&value, 1)));
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Writes descriptors to a file that appears whole or not at all. \param key kept in the file and compared
/// when it is read. \return false where that is not possible; then nothing is left behind.
bool write_descriptors(const std::filesystem::path& path, std::uint64_t key,
                       const std::vector<CloudDescriptor>& descriptors);

/// What write_descriptors wrote; empty for a file that is missing, damaged, or has another key.
std::optional<std::vector<CloudDescriptor>> read_descriptors(const std::filesystem::path& path,
                                                             std::uint64_t key);

}  // namespace perch
