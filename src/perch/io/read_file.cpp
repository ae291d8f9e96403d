#include "perch/io/read_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <new>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"

namespace perch {

std::uintmax_t check_file(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", shown(path), what));
  };
  if (path.native().find('\0') != std::string::npos)
    fail("the file name holds a NUL byte; give another name");
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file; check the path");
  if (error) fail(fmt::format("can't be read ({}); check the path and its permissions", error.message()));
  if (std::filesystem::is_directory(status)) fail("is a directory; name a file in it");
  if (!std::filesystem::is_regular_file(status)) fail("is not a regular file; copy the data to one");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) fail(fmt::format("can't be read ({}); check the path and its permissions", error.message()));
  if (size == 0) fail("is empty; write it again");
  if (size > most_bytes)
    fail(fmt::format("has {} bytes, more than the {} that are read; give a smaller file", size, most_bytes));
  errno = 0;
  if (!std::ifstream(path, std::ios::binary))
    fail(fmt::format("can't be opened ({}); check its permissions", std::strerror(errno)));
  return size;
}

std::string read_file(const std::filesystem::path& path, std::uintmax_t most_bytes) {
  const std::uintmax_t size = check_file(path, most_bytes);
  std::string bytes;
  try {
    bytes.resize(static_cast<std::size_t>(size));
  } catch (const std::bad_alloc&) {
    throw InputError(
        fmt::format("{}: has {} bytes, more than there is memory; give a smaller file", shown(path), size));
  }
  std::ifstream in(path, std::ios::binary);
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!in || in.gcount() != static_cast<std::streamsize>(bytes.size()))
    throw InputError(fmt::format("{}: can't be read to its end; check the disk and try again", shown(path)));
  return bytes;
}

}  // namespace perch
