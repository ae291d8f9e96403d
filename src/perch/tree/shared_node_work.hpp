#pragma once

#include <cstdint>
#include <vector>

#include "perch/tree/nodes_batch.hpp"

namespace perch {

/// Works on batches of nodes, in this process until that has taken long, then in all that there are. What
/// comes out is the same.
class SharedNodeWork {
 public:
  /// Others need to be told the candidates and draw them, which short searches are not worth.
  static constexpr double default_share_after = 0.1;

  /// Keeps references. \param kept of each candidate of the set: not 0 where nodes may hold it. \param
  /// share_after seconds that nodes must have taken here, or be expected to take.
  SharedNodeWork(const LocalizationProblem& problem, const CandidateSet& set, const std::vector<char>& kept,
                 std::vector<Lagrangian::Weight> point_weights, std::vector<CandidateMaker>& makers,
                 const Executor& executor, double share_after)
      : set_(set),
        candidates_(kept),
        work_(problem, set, std::move(point_weights)),
        makers_(makers),
        executor_(executor),
        share_after_(share_after) {}
  ~SharedNodeWork();
  SharedNodeWork(const SharedNodeWork&) = delete;
  SharedNodeWork& operator=(const SharedNodeWork&) = delete;

  /// One finding for each node; incomplete where the stop condition struck before.
  std::vector<NodeFinding> work(const std::vector<OpenNode>& nodes, std::int64_t upper_bound,
                                const StopCondition& stop);

 private:
  bool pays(std::size_t nodes) const;

  const CandidateSet& set_;
  const NodeCandidates candidates_;
  const NodeWork work_;
  std::vector<CandidateMaker>& makers_;
  const Executor& executor_;
  const double share_after_;
  bool told_ = false;          ///< others know the candidates
  double seconds_here_ = 0.0;  ///< that nodes took before
  std::size_t worked_here_ = 0;
};

}  // namespace perch
