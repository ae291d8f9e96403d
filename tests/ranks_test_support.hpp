#pragma once

#include "command_line_test_support.hpp"

// Runs the program by mpirun, as many times as one likes on this machine.
namespace perch::command_line {

/// The command for the program with so many ranks.
inline Arguments ranks_command(int ranks, const Arguments& arguments) {
  Arguments command{PERCH_MPIEXEC, "--allow-run-as-root", "--oversubscribe", "--bind-to", "none",
                    "-n",          std::to_string(ranks), PERCH_PROGRAM};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

/// What does not depend on the clock, nor on how many threads and ranks there were.
inline Json without_timings(Json result) {
  for (const char* key : {"seconds", "threads", "ranks"}) result["stats"].erase(key);
  return result;
}

}  // namespace perch::command_line
