#include "perch/eval/gnuplot.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "perch/io/message.hpp"

extern char** environ;

namespace perch {
namespace {

/// A file without a name, gone when closed. Pipes would have to be filled and emptied at the same time.
class NamelessFile {
 public:
  NamelessFile() : file_(std::tmpfile()) {
    if (!file_) throw std::system_error(errno, std::generic_category(), "no temporary file for gnuplot");
  }

  void fill(const std::string& bytes) const {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() ||
        std::fflush(file_.get()) != 0)
      throw std::system_error(errno, std::generic_category(),
                              "the temporary file for gnuplot can't be written");
    std::rewind(file_.get());
  }

  std::string bytes() const {
    std::string bytes;
    char block[4096];
    std::rewind(file_.get());
    while (const std::size_t n = std::fread(block, 1, sizeof block, file_.get())) bytes.append(block, n);
    return bytes;
  }

  int descriptor() const { return ::fileno(file_.get()); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace

NoGnuplot::NoGnuplot()
    : InputError("gnuplot is not installed: no figures; install the package gnuplot-nox") {}

std::string run_gnuplot(const std::string& script) {
  const NamelessFile in, out, err;
  in.fill(script);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.descriptor(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.descriptor(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err.descriptor(), STDERR_FILENO);
  char program[] = "gnuplot", without_settings[] = "-d";
  char* arguments[] = {program, without_settings, nullptr};
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, program, &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error == ENOENT || error == EACCES) throw NoGnuplot();
  if (error != 0) throw std::system_error(error, std::generic_category(), "gnuplot can't be started");
  int status = 0;
  while (::waitpid(pid, &status, 0) == -1 && errno == EINTR) continue;
  std::string bytes = out.bytes();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || bytes.empty())
    throw std::runtime_error(fmt::format("gnuplot failed: {}", one_line(err.bytes())));
  return bytes;
}

std::string quoted_for_gnuplot(std::string_view text) {
  std::string quoted = "'";
  for (const char c : text) {
    const bool printable = c >= 0x20 && c < 0x7f;  // bytes that are no UTF-8 would spoil an SVG
    // Even between single quotes, these might be taken for commands or macros.
    quoted += !printable || c == '`' || c == '@' || c == '\\' ? '_' : c;
    if (c == '\'') quoted += c;
  }
  return quoted + "'";
}

}  // namespace perch
