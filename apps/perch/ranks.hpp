#pragma once

#include <cstddef>
#include <memory>

#include "perch/parallel/executor.hpp"

namespace perch {
class Transport;
}

namespace perch::app {

/// The processes of this program that mpirun or srun started together; one where it was started alone. The
/// first does what the command line says, the others share in it.
class Ranks {
 public:
  /// Throws InputError where several were started that can't talk to each other.
  Ranks(int& argc, char**& argv);
  /// Lets the others end.
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  /// True in all but the first.
  bool serves() const;
  /// Shares in what the first does until it ends.
  void serve();
  /// Threads here, and those of all other processes for batches that are spread. \param threads of each; 0:
  /// the processors that it may use, shared with the others on the machine.
  std::unique_ptr<Executor> executor(std::size_t threads) const;
  /// Ends all processes at once, without waiting for anything.
  [[noreturn]] void abort(int status) const;

 private:
  struct Job;
  std::unique_ptr<Job> job_;  ///< empty where started alone
};

}  // namespace perch::app
