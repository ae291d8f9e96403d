#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <optional>

namespace perch {

/// Thrown by work that can't be left half done when its stop condition strikes.
struct Interrupted {};

/// When to give up: at a point in time, or when someone asks. Cheap enough to ask inside a batch. May be
/// asked from any thread; once true it stays true.
class StopCondition {
 public:
  using Clock = std::chrono::steady_clock;

  StopCondition() = default;
  explicit StopCondition(Clock::time_point deadline) : deadline_(deadline) {}
  static StopCondition after(double seconds) {
    return StopCondition(Clock::now() +
                         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)));
  }
  /// Strikes when `whole` does, which it refers to, and before its deadline by a share of the time left, or
  /// by `most` seconds if that is less: what comes afterwards needs time too.
  static StopCondition before(const StopCondition& whole, double share, double most) {
    StopCondition condition;
    condition.whole_ = &whole;
    if (whole.deadline_) {
      const double left = std::chrono::duration<double>(*whole.deadline_ - Clock::now()).count();
      const double kept = std::clamp(share * left, 0.0, most);
      condition.deadline_ =
          *whole.deadline_ - std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kept));
    }
    return condition;
  }
  /// Strikes when `whole` does, which it refers to, and after so many seconds.
  static StopCondition within(const StopCondition& whole, double seconds) {
    StopCondition condition = after(seconds);
    condition.whole_ = &whole;
    if (whole.deadline_) condition.deadline_ = std::min(*condition.deadline_, *whole.deadline_);
    return condition;
  }
  StopCondition(const StopCondition&) = delete;
  StopCondition& operator=(const StopCondition&) = delete;
  StopCondition(StopCondition&& other) noexcept
      : deadline_(other.deadline_), whole_(other.whole_), cancelled_(other.cancelled_.load()) {}

  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const {
    return cancelled_.load(std::memory_order_relaxed) || (whole_ != nullptr && whole_->cancelled());
  }
  bool out_of_time() const { return deadline_ && Clock::now() >= *deadline_; }
  bool operator()() const { return cancelled() || out_of_time(); }

 private:
  std::optional<Clock::time_point> deadline_;
  const StopCondition* whole_ = nullptr;
  std::atomic<bool> cancelled_{false};
};

}  // namespace perch
