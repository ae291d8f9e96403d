#pragma once

#include <cstdint>

#include "perch/parallel/local_network.hpp"
#include "recorded_run.hpp"

namespace perch {

struct SimulatedRun {
  double seconds = 0.0;
  std::uint64_t messages = 0, bytes = 0;  ///< news left out
};

/// Ranks of one thread each, as TeamExecutor and serve() have them work: a simulation of events with a clock
/// of its own. HandOut and Pace are those of the program; messages leave and reach a rank one after the other
/// at the link's bandwidth and take its latency; rank 0 takes in answers one after the other; who waits looks
/// for messages after naps, half of which are lost on average.
SimulatedRun simulate_ranks(const RecordedRun& run, std::size_t ranks, const Link& link);

/// The same time by a formula: see docs/cluster.md.
struct ModelledRun {
  double alone = 0.0;    ///< what rank 0 does alone
  double news = 0.0;     ///< until the last rank has heard all
  double shared = 0.0;   ///< batches whose work takes longest
  double rank0 = 0.0;    ///< batches that are held up by what rank 0 writes and takes in, or by its link
  double waiting = 0.0;  ///< ends of batches
  double seconds() const { return alone + news + shared + rank0 + waiting; }
};
ModelledRun model_ranks(const RecordedRun& run, std::size_t ranks, const Link& link);

}  // namespace perch
