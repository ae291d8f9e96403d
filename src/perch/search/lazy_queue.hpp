#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace perch::detail {

/// A state's place in a queue. Smaller keys go first, then the state that was seen first: a total order over
/// live entries, so that what comes out doesn't depend on how the heap happens to lie.
struct QueueEntry {
  double key = 0.0;
  double tie = 0.0;
  std::uint32_t index = 0;    ///< of the state
  std::uint32_t version = 0;  ///< of the state's place in OPEN; an entry of an older version is dead
};

/// A priority queue in which entries die without being told: `alive(entry)` says which count. Dead entries
/// are dropped when they come to the top, or all at once when they are more than half.
class LazyQueue {
 public:
  /// `alive_at_most` is an upper bound on the number of entries alive here.
  template <typename Alive>
  void push(const QueueEntry& entry, const Alive& alive, std::size_t alive_at_most) {
    if (entries_.size() >= smallest_compacted && entries_.size() > 2 * alive_at_most) {
      std::erase_if(entries_, [&](const QueueEntry& e) { return !alive(e); });
      std::make_heap(entries_.begin(), entries_.end(), after);
    }
    entries_.push_back(entry);
    std::push_heap(entries_.begin(), entries_.end(), after);
  }

  /// The first entry alive, or none. The pointer holds until the next push or pop.
  template <typename Alive>
  const QueueEntry* top(const Alive& alive) {
    while (!entries_.empty() && !alive(entries_.front())) pop();
    return entries_.empty() ? nullptr : &entries_.front();
  }

  void pop() {
    std::pop_heap(entries_.begin(), entries_.end(), after);
    entries_.pop_back();
  }

 private:
  static constexpr std::size_t smallest_compacted = 1024;

  static bool after(const QueueEntry& a, const QueueEntry& b) {
    return std::tie(a.key, a.tie, a.index) > std::tie(b.key, b.tie, b.index);
  }

  std::vector<QueueEntry> entries_;
};

}  // namespace perch::detail
