#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "perch/core/image.hpp"

namespace perch {

/// A set of pixels inside a window, one bit each, so that "any of these within that rectangle?" reads a few
/// words.
class BitWindow {
 public:
  /// Empties the set and gives it a new window; memory is reused.
  void reset(const Window& window) {
    window_ = window;
    words_per_row_ = (static_cast<std::size_t>(window.width()) + 63) / 64;
    bits_.assign(words_per_row_ * static_cast<std::size_t>(window.height()), 0);
    any_ = false;
  }
  const Window& window() const { return window_; }
  bool any() const { return any_; }

  void insert(int u, int v) {
    const std::size_t column = static_cast<std::size_t>(u - window_.u0);
    bits_[row(v) + column / 64] |= std::uint64_t{1} << (column % 64);
    any_ = true;
  }
  bool contains(int u, int v) const {
    if (!window_.contains(u, v)) return false;
    const std::size_t column = static_cast<std::size_t>(u - window_.u0);
    return ((bits_[row(v) + column / 64] >> (column % 64)) & 1) != 0;
  }

  /// True when the predicate holds for some pixel of the set inside `area`; stops at the first. Rows are
  /// taken from the middle of the area outwards.
  template <typename Predicate>
  bool any_of(const Window& area, Predicate predicate) const {
    const Window common = intersection(area, window_);
    if (common.empty()) return false;
    const int middle = std::clamp((area.v0 + area.v1) / 2, common.v0, common.v1 - 1);
    for (int step = 0; middle - step >= common.v0 || middle + step < common.v1; ++step) {
      if (middle - step >= common.v0 && any_in_row(middle - step, common, predicate)) return true;
      if (step > 0 && middle + step < common.v1 && any_in_row(middle + step, common, predicate)) return true;
    }
    return false;
  }

 private:
  template <typename Predicate>
  bool any_in_row(int v, const Window& columns, Predicate predicate) const {
    const std::size_t first = static_cast<std::size_t>(columns.u0 - window_.u0);
    const std::size_t last = static_cast<std::size_t>(columns.u1 - 1 - window_.u0);
    for (std::size_t word = first / 64; word <= last / 64; ++word) {
      std::uint64_t bits = bits_[row(v) + word];
      if (word == first / 64) bits &= ~std::uint64_t{0} << (first % 64);
      if (word == last / 64) bits &= ~std::uint64_t{0} >> (63 - last % 64);
      for (; bits != 0; bits &= bits - 1) {
        const int u = window_.u0 + static_cast<int>(word * 64) + std::countr_zero(bits);
        if (predicate(u, v)) return true;
      }
    }
    return false;
  }

  std::size_t row(int v) const { return static_cast<std::size_t>(v - window_.v0) * words_per_row_; }

  Window window_;
  std::size_t words_per_row_ = 0;
  std::vector<std::uint64_t> bits_;
  bool any_ = false;
};

}  // namespace perch
