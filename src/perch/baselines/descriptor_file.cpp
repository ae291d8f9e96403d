#include "perch/baselines/descriptor_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

namespace perch {
namespace {

// A file: mark, key, number of descriptors; for each whether it is of a region, its frame (row-major 3 x 4)
// and its histogram; the fingerprint of all that. In the machine's byte order: a cache does not travel.
constexpr std::string_view mark = "perch OUR-CVFH 1\n";
constexpr std::size_t frame_values = 12;
constexpr std::size_t descriptor_bytes =
    1 + frame_values * sizeof(double) + sizeof(CloudDescriptor::histogram);
constexpr std::size_t head_bytes = mark.size() + 2 * sizeof(std::uint64_t);

template <typename T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <typename T>
T take(std::string_view& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  bytes.remove_prefix(sizeof(T));
  return value;
}

std::uint64_t fingerprint(std::string_view bytes) {
  Fingerprint print;
  print.add(std::as_bytes(std::span(bytes)));
  return print.value();
}

std::string bytes_of(std::uint64_t key, const std::vector<CloudDescriptor>& descriptors) {
  std::string bytes(mark);
  bytes.reserve(head_bytes + descriptors.size() * descriptor_bytes + sizeof(std::uint64_t));
  put(bytes, key);
  put(bytes, std::uint64_t{descriptors.size()});
  for (const CloudDescriptor& descriptor : descriptors) {
    put(bytes, static_cast<char>(descriptor.of_region ? 1 : 0));
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        put(bytes, descriptor.frame_from_cloud.matrix()(row, column));
    put(bytes, descriptor.histogram);
  }
  put(bytes, fingerprint(bytes));
  return bytes;
}

std::optional<std::string> bytes_in(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  constexpr std::uintmax_t most = std::uintmax_t{1} << 30;
  if (error || size < head_bytes + sizeof(std::uint64_t) || size > most) return std::nullopt;
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return std::nullopt;
  return bytes;
}

}  // namespace

bool write_descriptors(const std::filesystem::path& path, std::uint64_t key,
                       const std::vector<CloudDescriptor>& descriptors) {
  static std::atomic<unsigned> written{0};
  const std::string bytes = bytes_of(key, descriptors);
  std::error_code error;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), error);
  const std::filesystem::path temporary =
      path.string() + fmt::format(".{}.{}.part", ::getpid(), written.fetch_add(1));
  bool whole = false;
  {
    std::ofstream file(temporary, std::ios::binary);
    whole = file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())) && file.flush();
  }
  if (whole) {
    error.clear();
    std::filesystem::rename(temporary, path, error);
    whole = !error;
  }
  if (!whole) std::filesystem::remove(temporary, error);
  return whole;
}

std::optional<std::vector<CloudDescriptor>> read_descriptors(const std::filesystem::path& path,
                                                             std::uint64_t key) {
  const std::optional<std::string> file = bytes_in(path);
  if (!file) return std::nullopt;
  std::string_view bytes(*file);
  std::string_view end = bytes.substr(bytes.size() - sizeof(std::uint64_t));
  bytes.remove_suffix(end.size());
  if (fingerprint(bytes) != take<std::uint64_t>(end) || !bytes.starts_with(mark)) return std::nullopt;
  bytes.remove_prefix(mark.size());
  if (take<std::uint64_t>(bytes) != key) return std::nullopt;
  const auto count = take<std::uint64_t>(bytes);
  if (bytes.size() % descriptor_bytes != 0 || bytes.size() / descriptor_bytes != count) return std::nullopt;
  std::vector<CloudDescriptor> descriptors(count);
  for (CloudDescriptor& descriptor : descriptors) {
    descriptor.of_region = take<char>(bytes) != 0;
    for (Eigen::Index row = 0; row < 3; ++row)
      for (Eigen::Index column = 0; column < 4; ++column)
        descriptor.frame_from_cloud.matrix()(row, column) = take<double>(bytes);
    descriptor.histogram = take<decltype(descriptor.histogram)>(bytes);
  }
  return descriptors;
}

}  // namespace perch
