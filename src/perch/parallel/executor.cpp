#include "perch/parallel/executor.hpp"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace perch {

bool Executor::spread(Batch& batch, const StopCondition& stop) const {
  if (!batch.fills_process())
    return for_each_batched(*this, batch.size(), batch.grain(), stop,
                            [&](std::size_t item, std::size_t worker) { batch.work(item, worker); });
  for (std::size_t item = 0; item < batch.size(); ++item) {
    if (stop()) return false;
    batch.work(item, 0);
  }
  return true;
}

bool SerialExecutor::for_each(std::size_t n, const Body& body, const StopCondition& stop) const {
  for (std::size_t i = 0; i < n; ++i) {
    if (stop()) return false;
    body(i, 0);
  }
  return true;
}

struct ThreadExecutor::Arena {
  explicit Arena(std::size_t threads)
      : control(tbb::global_control::max_allowed_parallelism, threads), arena(static_cast<int>(threads)) {}
  // oneTBB makes no more threads than the machine has cores unless told so.
  tbb::global_control control;
  tbb::task_arena arena;
};

ThreadExecutor::ThreadExecutor(std::size_t threads) : arena_(std::make_unique<Arena>(threads)) {}
ThreadExecutor::~ThreadExecutor() = default;

std::size_t ThreadExecutor::workers() const {
  return static_cast<std::size_t>(arena_->arena.max_concurrency());
}

bool ThreadExecutor::for_each(std::size_t n, const Body& body, const StopCondition& stop) const {
  std::atomic<bool> complete{true};
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, n, 1), [&](const tbb::blocked_range<std::size_t>& range) {
          const auto worker = static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
          for (std::size_t i = range.begin(); i != range.end(); ++i) {
            if (!complete.load(std::memory_order_relaxed) || stop()) {
              complete.store(false, std::memory_order_relaxed);
              return;
            }
            body(i, worker);
          }
        });
  });
  return complete.load();
}

std::unique_ptr<Executor> make_executor(std::size_t threads) {
  if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
  if (threads == 1) return std::make_unique<SerialExecutor>();
  return std::make_unique<ThreadExecutor>(threads);
}

}  // namespace perch
