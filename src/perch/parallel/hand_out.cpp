#include "perch/parallel/hand_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace perch {

void Pace::took(std::size_t process, std::size_t items, double seconds) {
  constexpr double newest = 0.3;          // its weight in a running mean
  constexpr double shortest_time = 1e-6;  // s, that a clock tells
  const double now = static_cast<double>(items) / std::max(seconds, shortest_time);
  double& mean = items_a_second_[process];
  mean = mean == 0.0 ? now : (1.0 - newest) * mean + newest * now;
}

double Pace::items_a_second() const {
  const auto known =
      std::count_if(items_a_second_.begin(), items_a_second_.end(), [](double pace) { return pace > 0.0; });
  if (known == 0) return 0.0;
  const double sum = std::accumulate(items_a_second_.begin(), items_a_second_.end(), 0.0);
  return sum / static_cast<double>(known) * static_cast<double>(items_a_second_.size());
}

HandOut::HandOut(const Batch& batch, const std::vector<std::size_t>& workers)
    : items_(batch.size()),
      shares_(workers.size()),
      workers_(workers),
      left_(batch.size()),
      grain_(batch.grain()),
      one_by_one_(batch.fills_process()) {
  if (one_by_one_) std::fill(workers_.begin(), workers_.end(), 1);
  all_workers_ = std::accumulate(workers_.begin(), workers_.end(), std::size_t{0});
  std::vector<std::size_t> process_of;  // of a worker of all
  for (std::size_t p = 0; p < workers_.size(); ++p) process_of.insert(process_of.end(), workers_[p], p);
  std::vector<std::size_t> owner(items_.size());
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const auto worker = static_cast<std::size_t>(batch.home(i) * static_cast<double>(all_workers_));
    owner[i] = process_of[std::min(worker, all_workers_ - 1)];
    ++shares_[owner[i]].last;
  }
  for (std::size_t p = 0, first = 0; p < shares_.size(); ++p) {
    const std::size_t size = shares_[p].last;
    shares_[p] = {first, first};
    first += size;
  }
  for (std::size_t i = 0; i < items_.size(); ++i) items_[shares_[owner[i]].last++] = i;
}

std::size_t HandOut::portion(std::size_t process, const Pace& pace) const {
  if (one_by_one_) return 1;
  const std::size_t least = grain_ * workers_[process];
  const double by_time = portion_seconds * pace.items_a_second(process);
  // Half of what would be the process's part if all left were handed out now.
  const double by_rest = 0.5 * static_cast<double>(left_) * static_cast<double>(workers_[process]) /
                         static_cast<double>(all_workers_);
  return std::max(least, static_cast<std::size_t>(std::min(by_time, by_rest)));
}

std::vector<std::size_t> HandOut::take(std::size_t process, const Pace& pace) {
  if (left_ == 0) return {};
  std::size_t n = portion(process, pace);
  std::vector<std::size_t> taken;
  Share& own = shares_[process];
  for (; n > 0 && own.size() > 0; --n) taken.push_back(items_[own.first++]);
  if (taken.empty()) {
    const auto time_left = [&](std::size_t p) {
      const double known = pace.items_a_second(p);
      return static_cast<double>(shares_[p].size()) /
             (known > 0.0 ? known : static_cast<double>(workers_[p]));
    };
    std::size_t most = 0;
    for (std::size_t p = 1; p < shares_.size(); ++p)
      if (shares_[most].size() == 0 || (shares_[p].size() > 0 && time_left(p) > time_left(most))) most = p;
    Share& other = shares_[most];
    for (; n > 0 && other.size() > 0; --n) taken.push_back(items_[--other.last]);
  }
  left_ -= taken.size();
  return taken;
}

}  // namespace perch
