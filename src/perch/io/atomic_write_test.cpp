#include "perch/io/atomic_write.hpp"

#include "perch/io/test_files.hpp"

namespace perch {
namespace {

using namespace testing_files;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::size_t entries(const std::filesystem::path& directory) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(directory), {}));
}

TEST(OutputSet, MakesTheDirectoryAndReplacesOldFiles) {
  const TemporaryDirectory dir;
  dir.write("a/b/one.txt", "old");
  OutputSet set;
  set.add("one.txt", "new");
  set.add("two.bin", std::string("\0\n", 2));
  set.commit(dir.path() / "a/b");
  set.commit(dir.path() / "fresh/deep/");
  for (const char* folder : {"a/b", "fresh/deep"}) {
    EXPECT_EQ(bytes_of(dir.path() / folder / "one.txt"), "new");
    EXPECT_EQ(bytes_of(dir.path() / folder / "two.bin"), std::string("\0\n", 2));
    EXPECT_EQ(entries(dir.path() / folder), 2U);
  }
}

TEST(OutputSet, LeavesNothingBehindWhenItFails) {
  const TemporaryDirectory dir;
  dir.write("out/one.txt", "old");
  std::filesystem::create_directories(dir.path() / "out/two.txt");
  OutputSet set;
  set.add("one.txt", "new");
  set.add("two.txt", "new");
  EXPECT_THAT(input_error([&] { set.commit(dir.path() / "out"); }),
              AllOf(HasSubstr("out/two.txt: can't be written"), HasSubstr("directory")));
  EXPECT_EQ(bytes_of(dir.path() / "out/one.txt"), "old");
  EXPECT_EQ(entries(dir.path() / "out"), 2U);

  dir.write("file", "x");
  EXPECT_THAT(input_error([&] { set.commit(dir.path() / "file"); }), HasSubstr("file: is not a directory"));
  EXPECT_THAT(input_error([&] { set.commit(dir.path() / "file/below"); }), HasSubstr("file/below"));
  EXPECT_EQ(bytes_of(dir.path() / "file"), "x");
}

TEST(OutputSet, RemovesTheDirectoriesThatItMade) {
  const TemporaryDirectory dir;
  OutputSet set;
  set.add(std::string(300, 'n'), "too long a name for any file system");
  input_error([&] { set.commit(dir.path() / "a/b/c"); });
  EXPECT_EQ(entries(dir.path()), 0U);
}

TEST(OutputSet, RehearsalThrowsWhatWritingWouldAndLeavesNothing) {
  const TemporaryDirectory dir;
  dir.write("file", "x");
  dir.write("out/one.txt", "old");
  std::filesystem::create_directories(dir.path() / "taken/one.txt");
  OutputSet set;
  set.add("one.txt", "new");
  for (const char* place : {"file", "file/below", "taken"}) {
    const std::string expected = input_error([&] { set.commit(dir.path() / place); });
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(input_error([&] { set.rehearse(dir.path() / place); }), expected);
  }
  set.rehearse(dir.path() / "out");
  set.rehearse(dir.path() / "a/b/c");
  EXPECT_EQ(bytes_of(dir.path() / "out/one.txt"), "old");
  EXPECT_EQ(entries(dir.path() / "out"), 1U);
  EXPECT_EQ(entries(dir.path()), 3U);
}

TEST(OutputSet, NewFoldersAppearWholeOrNotAtAll) {
  const TemporaryDirectory dir;
  OutputSet set;
  set.add("one.txt", "1");
  set.add("two.txt", "2");
  set.create_folder(dir.path() / "a/b");
  EXPECT_EQ(bytes_of(dir.path() / "a/b/two.txt"), "2");
  EXPECT_EQ(entries(dir.path() / "a"), 1U);
  dir.write("file", "x");
  for (const char* place : {"a/b", "a", "file", "file/below"})
    EXPECT_NE(input_error([&] { set.create_folder(dir.path() / place); }), "");
  set.add(std::string(300, 'n'), "too long a name for any file system");
  input_error([&] { set.create_folder(dir.path() / "c/d/e"); });
  EXPECT_EQ(entries(dir.path()), 2U);
  EXPECT_EQ(entries(dir.path() / "a"), 1U);
}

TEST(OutputSet, TakesPlainNamesOnly) {
  OutputSet set;
  for (const char* name : {"", "a/b", "/a", "..", "."})
    EXPECT_THROW(set.add(name, ""), std::invalid_argument);
}

TEST(WriteAtomically, WritesOneFile) {
  const TemporaryDirectory dir;
  write_atomically(dir.path() / "x", "bytes");
  EXPECT_EQ(bytes_of(dir.path() / "x"), "bytes");
  EXPECT_EQ(entries(dir.path()), 1U);
}

}  // namespace
}  // namespace perch
