#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "perch/core/bytes.hpp"
#include "perch/core/stop.hpp"
#include "perch/parallel/batch.hpp"

namespace perch {

/// What passed between this process and others so far, both ways.
struct Traffic {
  std::uint64_t messages = 0, bytes = 0;
  std::uint64_t news_bytes = 0;  ///< of these: told to all
  std::uint64_t items = 0;       ///< of batches, worked on in other processes
};

/// Runs "evaluate this batch": the body once for every index of a batch. A body writes its result to the
/// place of its index, so that what comes out doesn't depend on who ran it or when.
class Executor {
 public:
  /// \param index place in the batch. \param worker which of the workers() runs it: for scratch memory of its
  /// own.
  using Body = std::function<void(std::size_t index, std::size_t worker)>;

  virtual ~Executor() = default;
  virtual std::size_t workers() const = 0;
  /// True when the body has run for every index 0 .. n - 1; false when the stop condition, asked before each,
  /// struck first.
  virtual bool for_each(std::size_t n, const Body& body, const StopCondition& stop) const = 0;

  /// As for_each over the batch's items, which other processes may share in.
  virtual bool spread(Batch& batch, const StopCondition& stop) const;
  /// The threads of this process alone: for the work on an item of a batch that is spread.
  virtual const Executor& own() const { return *this; }
  /// How many processes share in batches, this one included.
  virtual std::size_t processes() const { return 1; }
  /// Lets the services of this topic in all other processes hear something, before any batch that is spread
  /// later.
  virtual void tell(const std::string& /*topic*/, Bytes /*what*/) const {}
  virtual Traffic traffic() const { return {}; }
};

/// One after the other, in index order.
class SerialExecutor final : public Executor {
 public:
  std::size_t workers() const override { return 1; }
  bool for_each(std::size_t n, const Body& body, const StopCondition& stop) const override;
};

/// On oneTBB's work-stealing threads.
class ThreadExecutor final : public Executor {
 public:
  /// \param threads > 0.
  explicit ThreadExecutor(std::size_t threads);
  ~ThreadExecutor() override;
  std::size_t workers() const override;
  bool for_each(std::size_t n, const Body& body, const StopCondition& stop) const override;

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;
};

/// A serial executor for one thread, else threads; 0 = as many as the machine has.
std::unique_ptr<Executor> make_executor(std::size_t threads);

/// As Executor::for_each, so many indices at a time: for bodies that take a few microseconds.
template <typename Body>
bool for_each_batched(const Executor& executor, std::size_t n, std::size_t batch, const StopCondition& stop,
                      const Body& body) {
  return executor.for_each((n + batch - 1) / batch,
                           [&](std::size_t b, std::size_t worker) {
                             for (std::size_t i = b * batch; i < std::min(n, (b + 1) * batch); ++i)
                               body(i, worker);
                           },
                           stop);
}

}  // namespace perch
