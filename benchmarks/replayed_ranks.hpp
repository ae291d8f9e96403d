#pragma once

#include "perch/parallel/local_network.hpp"
#include "simulated_ranks.hpp"

namespace perch {

/// The recorded run by TeamExecutor and serve() themselves, over an in-process network with this link, in
/// real time: the other ranks sleep for as long as answers took and send as many bytes; rank 0 works for as
/// long as it did.
SimulatedRun replay_ranks(const RecordedRun& run, std::size_t ranks, const Link& link);

}  // namespace perch
