#pragma once

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "perch/io/png.hpp"
#include "perch/sim/scene_folder.hpp"
#include "perch/sim/scene_generator.hpp"

// Runs the program as a user does, on a small scene in a folder of its own.
namespace perch::command_line {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

inline std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline void write(const fs::path& path, std::string_view bytes) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A folder that is gone when the test is.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "perch-command-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Relative path to a hash of the bytes of all that is in a folder; a folder in it has none.
inline std::map<std::string, std::size_t> contents(const fs::path& folder) {
  std::map<std::string, std::size_t> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    out[fs::relative(entry.path(), folder).generic_string()] =
        entry.is_regular_file() ? std::hash<std::string>()(bytes_of(entry.path())) : 0;
  return out;
}

/// How a run of the program ended and what it said.
struct Outcome {
  int status = -1;  ///< exit status; -1 where there is none
  int signal = 0;   ///< that ended it; SIGKILL where it took too long
  std::string out, err;

  auto error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
};

inline std::ostream& operator<<(std::ostream& stream, const Outcome& outcome) {
  return stream << "status " << outcome.status << ", signal " << outcome.signal << "\nstdout: " << outcome.out
                << "\nstderr: " << outcome.err;
}

/// Runs a command, a program and its arguments, in `folder`; what it writes to stdout and stderr passes
/// through files elsewhere. \param meanwhile called again and again while it runs.
inline Outcome run_command(
    const fs::path& folder, Arguments command, std::chrono::seconds limit = std::chrono::seconds(120),
    const std::function<void()>& meanwhile = [] {}) {
  const TemporaryFolder aside;
  const std::string out = (aside.path() / "out").string(), err = (aside.path() / "err").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::vector<char*> argv;
  for (std::string& argument : command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  const int failed = posix_spawnp(&pid, argv.front(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw std::runtime_error("the program can't be started");

  const auto deadline = std::chrono::steady_clock::now() + limit;
  int ended = 0;
  while (waitpid(pid, &ended, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) {
      kill(pid, SIGKILL);
      waitpid(pid, &ended, 0);
      break;
    }
    meanwhile();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  Outcome outcome;
  if (WIFEXITED(ended)) outcome.status = WEXITSTATUS(ended);
  if (WIFSIGNALED(ended)) outcome.signal = WTERMSIG(ended);
  outcome.out = bytes_of(out);
  outcome.err = bytes_of(err);
  return outcome;
}

/// Runs the program in `folder`.
inline Outcome run_program(const fs::path& folder, const Arguments& arguments,
                           std::chrono::seconds limit = std::chrono::seconds(120)) {
  Arguments command{PERCH_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return run_command(folder, std::move(command), limit);
}

/// Two objects on a table at 160 x 120 pixels.
inline SimulatedScene small_scene(std::uint64_t seed) {
  TabletopOptions options;
  options.min_objects = options.max_objects = 2;
  options.repeats = false;
  options.models = {"can", "mug"};
  options.width = 160;
  options.height = 120;
  options.least_visible = 0.6;
  return random_tabletop(seed, options);
}

/// The text with the lines from the one that begins with `first` to before the one that begins with `next`
/// (leading blanks aside) put as `lines`. Throws where there is no such line.
inline std::string with_lines(const std::string& text, std::string_view first, std::string_view next,
                              std::string_view lines) {
  const auto line_at = [&](std::string_view begin, std::size_t from) {
    for (std::size_t at = from; at < text.size(); at = text.find('\n', at) + 1) {
      const std::size_t word = std::min(text.find_first_not_of(" -", at), text.size());
      if (text.compare(word, begin.size(), begin) == 0) return at;
      if (text.find('\n', at) == std::string::npos) break;
    }
    throw std::logic_error("no such line: " + std::string(begin));
  };
  const std::size_t begin = line_at(first, 0);
  const std::size_t end = next.empty() ? text.find('\n', begin) + 1 : line_at(next, begin);
  return text.substr(0, begin) + std::string(lines) + text.substr(end);
}

/// The text with the one line that begins with `first` put as `line`.
inline std::string with_line(const std::string& text, std::string_view first, std::string_view line) {
  return with_lines(text, first, "", std::string(line) + "\n");
}

/// The text with the first `from` put as `to`. Throws where there is none.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("not in the text: " + std::string(from));
  return text.replace(at, from.size(), to);
}

/// The scene and its files in a folder: scene.yaml, depth.png, models/can.ply, models/mug.ply.
class CommandLine : public ::testing::Test {
 protected:
  CommandLine() : scene(small_scene(1)) {
    write_scene_folder(folder(), scene, "");
    yaml = bytes_of(folder() / "scene.yaml");
  }

  const fs::path& folder() const { return temporary_.path(); }

  /// A coarse grid, so that a run takes a fraction of a second.
  static Arguments coarse(Arguments arguments) {
    arguments.insert(arguments.end(), {"--resolution", "0.08", "--yaw-resolution-deg", "45"});
    return arguments;
  }

  Outcome run(const Arguments& arguments) const { return run_program(folder(), arguments); }

  Json json(const fs::path& file) const { return Json::parse(bytes_of(folder() / file)); }

  /// The command must be refused as bad input, with a message that holds the words, and nothing may change
  /// in the folder.
  void expect_refused(const Arguments& arguments, const std::vector<std::string>& words) const {
    const auto before = contents(folder());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, ::testing::StartsWith("perch: "));
    EXPECT_THAT(outcome.err, ::testing::Not(::testing::HasSubstr("internal error")));
    EXPECT_THAT(outcome.err, ::testing::EndsWith("\n"));
    EXPECT_GE(outcome.error_lines(), 1);
    EXPECT_LE(outcome.error_lines(), 2) << outcome.err;
    for (const std::string& word : words) EXPECT_THAT(outcome.err, ::testing::HasSubstr(word));
    EXPECT_EQ(contents(folder()), before) << "files were left behind or changed";
  }

  SimulatedScene scene;
  std::string yaml;

 private:
  TemporaryFolder temporary_;
};

}  // namespace perch::command_line
