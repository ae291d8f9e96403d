#pragma once

#include "perch/candidates/candidate.hpp"
#include "perch/core/bytes.hpp"

namespace perch {

/// A candidate that is not absent as it goes from one process to another: its costs and its sets, as runs;
/// not its rendering.
void write_candidate(ByteWriter& to, const Candidate& candidate);
Candidate read_candidate(ByteReader& from);

void write_window(ByteWriter& to, const Window& window);
Window read_window(ByteReader& from);

}  // namespace perch
