#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "perch/observation/run.hpp"

namespace perch {

/// A set of points of I, one bit a point; a candidate's set is stored from its first non-zero word to its
/// last.
class PointSet {
 public:
  PointSet() = default;
  /// All points of I, none in the set.
  explicit PointSet(std::size_t points) : words_((points + 63) / 64, 0) {}

  /// The points of these runs, ascending, in as little memory as they need.
  explicit PointSet(const std::vector<Run>& runs);

  /// Only on a set made for all points.
  void insert(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  void erase(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
  void clear();
  bool contains(std::size_t i) const {
    const std::size_t word = i / 64;
    return word >= first_ && word - first_ < words_.size() && ((words_[word - first_] >> (i % 64)) & 1) != 0;
  }

  std::size_t count() const;
  /// How many of the points from `first` to before `last` are in the set; only on a set made for all points.
  std::size_t count_between(std::size_t first, std::size_t last) const;
  /// Points of this set that are not in `other`; `other` holds all points of I.
  std::size_t count_not_in(const PointSet& other) const;
  /// Adds the points of `other`; this set holds all points of I.
  void insert_all(const PointSet& other);
  /// The same set in as little memory as it needs.
  PointSet trimmed() const;
  /// Its points, ascending.
  std::vector<Run> runs() const;
  std::size_t bytes() const { return words_.size() * sizeof(std::uint64_t); }

 private:
  std::size_t first_ = 0;
  std::vector<std::uint64_t> words_;
};

/// 0 for the points of I that are in a set made for all points, 1 for the others.
std::vector<std::int64_t> weights_outside(const PointSet& set, std::size_t points);

}  // namespace perch
