#pragma once

#include <string>
#include <vector>

#include "perch/localize/result.hpp"

namespace perch {

/// result.json: the keys in their documented order, numbers that read back as the same double, null where a
/// value is absent; ends with a newline. Without a bound `guarantee` is null, and a last key `counted_with`
/// holds delta and missing_depth.
std::string to_json(const Result& result);

/// trace.jsonl: a line {seconds, cost, search_cost, lower_bound, expanded} for each time that the scene or
/// its bound got better.
std::string to_json_lines(const std::vector<TraceEntry>& trace);

/// The records of `score` as a JSON array, one a given scene; ends with a newline.
std::string to_json(const std::vector<ScoreRecord>& records);

}  // namespace perch
