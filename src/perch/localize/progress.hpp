#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "perch/core/stopwatch.hpp"
#include "perch/localize/result.hpp"

namespace perch {

/// How far a localization has come.
struct Progress {
  const char* stage = "";  ///< "candidates", "first scenes", "bound", "search", "polish"
  std::uint64_t states = 0;
  std::uint64_t expansions = 0;
  std::optional<std::int64_t> best_cost = std::nullopt;
  std::int64_t lower_bound = 0;
};

/// Tells whoever listens how far a run has come, and keeps a trace of each better scene or bound.
class ProgressLog {
 public:
  explicit ProgressLog(const std::function<void(const Progress&)>& listener) : listener_(listener) {}

  void stage(const char* name) {
    now_.stage = name;
    tell();
  }
  void counts(std::uint64_t states, std::uint64_t expansions) {
    now_.states = states;
    now_.expansions = expansions;
  }
  /// A scene and a bound that are known now; worse ones than before change nothing.
  void improved(std::optional<std::int64_t> cost, std::int64_t lower_bound);
  /// The polished scene's cost, at the end.
  void polished(std::int64_t cost, std::int64_t search_cost, std::int64_t lower_bound);
  void tell() const {
    if (listener_) listener_(now_);
  }
  const std::vector<TraceEntry>& trace() const { return trace_; }

 private:
  const std::function<void(const Progress&)>& listener_;
  Stopwatch watch_;
  Progress now_;
  std::vector<TraceEntry> trace_;
};

}  // namespace perch
