#pragma once

#include <cstddef>
#include <string>

#include "perch/core/bytes.hpp"
#include "perch/core/stop.hpp"

namespace perch {

class Executor;

/// Items that may be worked on in several processes. Whoever works on an item, and when, doesn't change what
/// comes out: work() here, or in another process a Service that is asked write_question() and whose answer
/// read_answer() takes in.
class Batch {
 public:
  virtual ~Batch() = default;
  virtual std::size_t size() const = 0;
  /// The name of the service that answers in other processes.
  virtual std::string topic() const = 0;
  /// Works on an item here, as Executor::Body.
  virtual void work(std::size_t item, std::size_t worker) = 0;

  /// What all questions have in common, sent to each process that takes part, once. Called once at most.
  virtual void write_common(ByteWriter&) const {}
  virtual void write_question(std::size_t item, ByteWriter& question) const = 0;
  /// Called on the thread that spreads the batch, beside work() on other items. What it throws ends the batch
  /// as what work() throws does.
  virtual void read_answer(std::size_t item, ByteReader& answer) = 0;
  /// What a process says of a portion as a whole, e.g. what it counted.
  virtual void read_report(ByteReader&) {}

  /// Called beside work() where what is left is not wanted any more: work() may throw Interrupted then.
  virtual void give_up() {}

  /// Where in [0, 1) an item is at home: items at the same place of batches with the same topic go to the
  /// same process where that costs no time, so that it can use again what it keeps of them.
  virtual double home(std::size_t item) const {
    return static_cast<double>(item) / static_cast<double>(size());
  }
  /// Items that a thread takes at a time; more than one where each takes a few microseconds.
  virtual std::size_t grain() const { return 1; }
  /// True where an item keeps all threads of a process busy: they are handed out one by one, and worked on
  /// one after the other.
  virtual bool fills_process() const { return false; }
};

/// Works on items in the place of another process. Kept for as long as the program runs.
class Service {
 public:
  virtual ~Service() = default;
  /// Takes in what is told to all (Executor::tell) or what a batch's questions have in common. \param
  /// executor to be used for what is worked on, lives as long as the service.
  virtual void hear(ByteReader& common, const Executor& executor, const StopCondition& stop) = 0;
  /// Called by several threads at once, each with a number of its own; where a batch fills the process, by
  /// one.
  virtual void answer(ByteReader& question, std::size_t worker, const StopCondition& stop,
                      ByteWriter& answer) = 0;
  /// Called after all items of a portion.
  virtual void report(ByteWriter&) {}
};

}  // namespace perch
