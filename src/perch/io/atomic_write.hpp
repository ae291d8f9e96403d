#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace perch {

/// Files that appear together: all are written under temporary names in the same directory first, then
/// renamed.
class OutputSet {
 public:
  /// \param name a plain file name, without folders.
  void add(std::string name, std::string bytes);
  /// Names and bytes, in the order in which they were added and commit() makes them appear.
  const std::vector<std::pair<std::string, std::string>>& files() const { return files_; }

  /// Makes the directory where it is missing and writes the files, over files of the same names. Throws
  /// InputError that names the path and the reason; then no file and no directory made here is left, and
  /// files of the same names are as they were (unless the disk fails between two renames).
  void commit(const std::filesystem::path& directory) const;

  /// Writes the files into a new folder, which appears with all of them or not at all. Throws as commit(),
  /// also where there is something of that name already.
  void create_folder(const std::filesystem::path& folder) const;

  /// Does what commit() does up to the renaming, and undoes it: throws where commit() would, so that a place
  /// that can't be written to is known before the work is done.
  void rehearse(const std::filesystem::path& directory) const;

 private:
  std::vector<std::pair<std::string, std::string>> files_;
};

/// One file, whole or not at all. Throws as OutputSet::commit.
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace perch
