#include "perch/io/atomic_write.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, std::string_view what, std::string_view reason) {
  throw InputError(
      fmt::format("{}: {} ({}); choose another place or free this one", shown(path), what, reason));
}

/// What has been made so far, unmade again unless kept.
class Undo {
 public:
  Undo() = default;
  ~Undo() {
    std::error_code ignored;
    for (auto it = made_.rbegin(); it != made_.rend(); ++it) fs::remove(*it, ignored);
  }
  Undo(const Undo&) = delete;
  Undo& operator=(const Undo&) = delete;

  void remember(fs::path path) { made_.push_back(std::move(path)); }
  void keep() { made_.clear(); }

 private:
  std::vector<fs::path> made_;
};

void make_directories(const fs::path& directory, Undo& undo) {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path p = directory; !p.empty() && !fs::exists(p, error); p = p.parent_path()) missing.push_back(p);
  for (auto it = missing.rbegin(); it != missing.rend(); ++it) {
    if (fs::create_directory(*it, error))
      undo.remember(*it);
    else if (error)
      fail(*it, "the directory can't be made", error.message());
  }
  if (!fs::is_directory(directory, error))
    fail(directory, "is not a directory", error ? error.message() : "a file has this name");
}

void write_new_file(const fs::path& path, const fs::path& wanted, std::string_view bytes, Undo& undo) {
  errno = 0;
  std::FILE* file = std::fopen(path.c_str(), "wbx");
  if (!file) fail(wanted, "can't be written", std::strerror(errno));
  undo.remember(path);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  int reason = errno;
  const bool closed = std::fclose(file) == 0;
  if (written && !closed) reason = errno;
  if (!written || !closed) fail(wanted, "can't be written", std::strerror(reason));
}

fs::path temporary_name(const fs::path& directory) {
  static std::atomic<unsigned> count{0};
  return directory / fmt::format(".perch-{}-{}.part", ::getpid(), count++);
}

/// Names and bytes as in OutputSet.
std::vector<fs::path> write_temporaries(const std::vector<std::pair<std::string, std::string>>& files,
                                        const fs::path& directory, Undo& undo) {
  make_directories(directory.has_filename() ? directory : directory.parent_path(), undo);
  std::vector<fs::path> temporaries;
  std::error_code error;
  for (const auto& [name, bytes] : files) {
    const fs::path target = directory / name;
    if (fs::is_directory(target, error)) fail(target, "can't be written", "it is a directory");
    temporaries.push_back(temporary_name(directory));
    write_new_file(temporaries.back(), target, bytes, undo);
  }
  return temporaries;
}

}  // namespace

void OutputSet::add(std::string name, std::string bytes) {
  if (name.empty() || fs::path(name).filename() != fs::path(name) || name == "." || name == "..")
    throw std::invalid_argument("not a plain file name: " + one_line(name));
  files_.emplace_back(std::move(name), std::move(bytes));
}

void OutputSet::commit(const fs::path& wanted) const {
  const fs::path directory = wanted.empty() ? fs::path(".") : wanted.lexically_normal();
  Undo undo;
  const std::vector<fs::path> temporaries = write_temporaries(files_, directory, undo);
  std::error_code error;
  for (std::size_t i = 0; i < files_.size(); ++i) {
    fs::rename(temporaries[i], directory / files_[i].first, error);
    if (error) fail(directory / files_[i].first, "can't be written", error.message());
  }
  undo.keep();
}

void OutputSet::create_folder(const fs::path& wanted) const {
  const fs::path folder = wanted.lexically_normal();
  if (!folder.has_filename()) fail(wanted, "can't be made", "it names no folder");
  const fs::path parent = folder.has_parent_path() ? folder.parent_path() : fs::path(".");
  Undo undo;
  make_directories(parent, undo);
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder, error))) fail(folder, "can't be made", "something has this name");
  const fs::path temporary = temporary_name(parent);
  if (!fs::create_directory(temporary, error)) fail(folder, "can't be made", error.message());
  undo.remember(temporary);
  for (const auto& [name, bytes] : files_) write_new_file(temporary / name, folder / name, bytes, undo);
  fs::rename(temporary, folder, error);
  if (error) fail(folder, "can't be made", error.message());
  undo.keep();
}

void OutputSet::rehearse(const fs::path& wanted) const {
  Undo undo;
  write_temporaries(files_, wanted.empty() ? fs::path(".") : wanted.lexically_normal(), undo);
}

void write_atomically(const fs::path& path, std::string_view bytes) {
  if (!path.has_filename()) fail(path, "can't be written", "it names no file");
  OutputSet set;
  set.add(path.filename().string(), std::string(bytes));
  set.commit(path.parent_path());
}

}  // namespace perch
