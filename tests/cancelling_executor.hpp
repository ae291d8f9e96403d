#pragma once

#include <cstdint>

#include "perch/parallel/executor.hpp"

namespace perch {

/// Cancels after a number of bodies have run: the clock without the clock.
class CancellingExecutor final : public Executor {
 public:
  CancellingExecutor(StopCondition& stop, std::int64_t bodies) : stop_(stop), left_(bodies) {}
  std::size_t workers() const override { return 1; }
  bool for_each(std::size_t n, const Body& body, const StopCondition& stop) const override {
    for (std::size_t i = 0; i < n; ++i) {
      if (stop()) return false;
      if (--left_ < 0) stop_.cancel();
      if (stop_()) ++after_;
      body(i, 0);
    }
    return true;
  }
  /// Bodies run once cancelled.
  std::int64_t after() const { return after_; }

 private:
  StopCondition& stop_;
  mutable std::int64_t left_;
  mutable std::int64_t after_ = 0;
};

}  // namespace perch
