#pragma once

#include <vector>

#include "perch/core/bytes.hpp"
#include "perch/observation/run.hpp"

namespace perch {

/// Runs, ascending, as the gap before each and its length: two or three bytes a run.
inline void write_runs(ByteWriter& to, const std::vector<Run>& runs) {
  to.count(runs.size());
  std::uint32_t last = 0;
  for (const Run& run : runs) {
    to.count(run.first - last);
    to.count(run.last - run.first);
    last = run.last;
  }
}

inline std::vector<Run> read_runs(ByteReader& from) {
  std::vector<Run> runs(from.count());
  std::uint32_t last = 0;
  for (Run& run : runs) {
    run.first = last + static_cast<std::uint32_t>(from.count());
    run.last = last = run.first + static_cast<std::uint32_t>(from.count());
  }
  return runs;
}

}  // namespace perch
