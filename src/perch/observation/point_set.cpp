#include "perch/observation/point_set.hpp"

#include <algorithm>

#define PERCH_KERNELS "perch/observation/bit_counts.inc"
#include "perch/core/for_each_instruction_set.hpp"

namespace perch {

PointSet::PointSet(const std::vector<Run>& runs) {
  if (runs.empty()) return;
  first_ = runs.front().first / 64;
  words_.assign((runs.back().last - 1) / 64 - first_ + 1, 0);
  for (const Run& run : runs) {
    const std::size_t from = run.first / 64 - first_, to = (run.last - 1) / 64 - first_;
    const std::uint64_t head = ~std::uint64_t{0} << (run.first % 64),
                        tail = ~std::uint64_t{0} >> (63 - (run.last - 1) % 64);
    if (from == to) {
      words_[from] |= head & tail;
      continue;
    }
    words_[from] |= head;
    for (std::size_t word = from + 1; word < to; ++word) words_[word] = ~std::uint64_t{0};
    words_[to] |= tail;
  }
}

void PointSet::clear() {
  std::fill(words_.begin(), words_.end(), 0);
}

std::size_t PointSet::count() const {
  return PERCH_CALL(count_bits, words_.data(), words_.size());
}

std::size_t PointSet::count_between(std::size_t first, std::size_t last) const {
  if (first >= last) return 0;
  const std::size_t from = first / 64, to = (last - 1) / 64;
  const std::uint64_t head = ~std::uint64_t{0} << (first % 64),
                      tail = ~std::uint64_t{0} >> (63 - (last - 1) % 64);
  if (from == to) return static_cast<std::size_t>(std::popcount(words_[from] & head & tail));
  return static_cast<std::size_t>(std::popcount(words_[from] & head) + std::popcount(words_[to] & tail)) +
         PERCH_CALL(count_bits, words_.data() + from + 1, to - from - 1);
}

std::size_t PointSet::count_not_in(const PointSet& other) const {
  return PERCH_CALL(count_bits_not_in, words_.data(), other.words_.data() + first_, words_.size());
}

void PointSet::insert_all(const PointSet& other) {
  for (std::size_t i = 0; i < other.words_.size(); ++i) words_[other.first_ + i] |= other.words_[i];
}

std::vector<Run> PointSet::runs() const {
  std::vector<Run> runs;
  for (std::size_t word = 0; word < words_.size(); ++word) {
    std::uint64_t bits = words_[word];
    for (unsigned at = 0; bits != 0;) {
      const auto gap = static_cast<unsigned>(std::countr_zero(bits));
      bits >>= gap;
      at += gap;
      const auto length = static_cast<unsigned>(std::countr_one(bits));
      const auto first = static_cast<std::uint32_t>((first_ + word) * 64 + at);
      append(runs, first, first + length);
      bits = length == 64 ? 0 : bits >> length;
      at += length;
    }
  }
  return runs;
}

PointSet PointSet::trimmed() const {
  const auto used = [](std::uint64_t word) { return word != 0; };
  const auto begin = std::find_if(words_.begin(), words_.end(), used);
  const auto end = std::find_if(words_.rbegin(), std::make_reverse_iterator(begin), used).base();
  PointSet set;
  set.words_.assign(begin, end);
  set.first_ =
      words_.empty() || begin == words_.end() ? 0 : first_ + static_cast<std::size_t>(begin - words_.begin());
  return set;
}

std::vector<std::int64_t> weights_outside(const PointSet& set, std::size_t points) {
  std::vector<std::int64_t> weights(points);
  for (std::size_t i = 0; i < points; ++i) weights[i] = set.contains(i) ? 0 : 1;
  return weights;
}

}  // namespace perch
