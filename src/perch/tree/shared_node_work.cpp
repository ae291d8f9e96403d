#include "perch/tree/shared_node_work.hpp"

#include <algorithm>
#include <span>

#include "perch/core/stopwatch.hpp"

namespace perch {

SharedNodeWork::~SharedNodeWork() {
  if (told_) executor_.tell(NodesBatch::name, write_no_candidates());
}

std::vector<NodeFinding> SharedNodeWork::work(const std::vector<OpenNode>& nodes, std::int64_t upper_bound,
                                              const StopCondition& stop) {
  std::vector<NodeFinding> findings(nodes.size());
  const auto batch = [&](std::size_t first, std::size_t size) {
    return NodesBatch(work_, candidates_, std::span(nodes).subspan(first, size), upper_bound, makers_, stop,
                      std::span(findings).subspan(first, size));
  };
  std::size_t first = 0;
  while (executor_.processes() > 1 && !told_ && first < nodes.size()) {
    if (pays(nodes.size() - first)) {
      executor_.tell(NodesBatch::name, write_candidates(set_, candidates_, work_));
      told_ = true;
      break;
    }
    const Stopwatch watch;
    NodesBatch here = batch(first, std::min(executor_.workers(), nodes.size() - first));
    executor_.for_each(
        here.size(), [&](std::size_t item, std::size_t worker) { here.work(item, worker); }, stop);
    if (stop()) return findings;
    first += here.size();
    worked_here_ += here.size();
    seconds_here_ += watch.seconds();
  }
  NodesBatch rest = batch(first, nodes.size() - first);
  executor_.spread(rest, stop);
  makers_.front().credit(rest.effort_elsewhere);
  return findings;
}

/// \param nodes how many are to be worked on now.
bool SharedNodeWork::pays(std::size_t nodes) const {
  const double ahead = worked_here_ == 0
                           ? 0.0
                           : seconds_here_ * static_cast<double>(nodes) / static_cast<double>(worked_here_);
  return seconds_here_ + ahead >= share_after_;
}

}  // namespace perch
