#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "perch/parallel/batch.hpp"

namespace perch {

/// How fast the processes work on the items of a topic, as measured.
class Pace {
 public:
  explicit Pace(std::size_t processes) : items_a_second_(processes, 0.0) {}

  void took(std::size_t process, std::size_t items, double seconds);
  /// Of a process; 0 where it is not known yet.
  double items_a_second(std::size_t process) const { return items_a_second_[process]; }
  /// Of all; a process that is not known yet is taken to be like the others.
  double items_a_second() const;

 private:
  std::vector<double> items_a_second_;
};

/// Decides which items of a batch a process gets next. Each has the items at home with it, and when these are
/// gone takes from whoever has most left for its pace. Portions are as large as take a set time by the pace,
/// and towards the end smaller, so that all get ready together.
class HandOut {
 public:
  /// \param workers of each process, > 0.
  HandOut(const Batch& batch, const std::vector<std::size_t>& workers);

  /// Ascending or, where taken from another, descending; empty where nothing is left.
  std::vector<std::size_t> take(std::size_t process, const Pace& pace);
  std::size_t left() const { return left_; }

  static constexpr double portion_seconds = 0.01;

 private:
  /// Those of one process that are not handed out yet: places first .. last - 1 of items_.
  struct Share {
    std::size_t first = 0, last = 0;
    std::size_t size() const { return last - first; }
  };
  std::size_t portion(std::size_t process, const Pace& pace) const;

  std::vector<std::size_t> items_;  ///< by home
  std::vector<Share> shares_;
  std::vector<std::size_t> workers_;
  std::size_t all_workers_ = 0, left_ = 0, grain_ = 1;
  bool one_by_one_ = false;
};

}  // namespace perch
