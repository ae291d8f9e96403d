#include "perch/heuristics/heuristics.hpp"

namespace perch {

double bound_heuristic(const SceneState& state) {
  return static_cast<double>(state.bound - state.cost);
}

double DepthHeuristic::operator()(const SceneState& state) const {
  return static_cast<double>(object_count_ - state.placed.size());
}

double OverlapHeuristic::operator()(const SceneState& state) const {
  PointSet reached(problem_.observation().size());
  for (const CandidateId id : state.placed) reached.insert_all(set_[id].reached);
  return static_cast<double>(problem_.observation().size() - reached.count());
}

double PriorHeuristic::operator()(const SceneState& state) const {
  double sum = 0.0;
  distances_.resize(set_.size());
  for (const CandidateId id : state.placed) {
    std::optional<double>& distance = distances_[id];
    if (!distance) distance = prior_distance(problem_, set_[id], priors_);
    sum += *distance;
  }
  return sum;
}

}  // namespace perch
