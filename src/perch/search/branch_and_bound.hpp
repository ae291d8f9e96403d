#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/core/stop.hpp"
#include "perch/search/search_result.hpp"

namespace perch {

/// What working on one node gave.
template <typename Node, typename Solution>
struct Branching {
  /// Every solution of the node that costs less than the incumbent and is not `found` lies in one of these.
  std::vector<Node> children;
  std::optional<Incumbent<Solution>> found;  ///< the best solution met on the way, if any
  /// False only where the stop condition struck: the children mean nothing then, `found` still counts.
  bool complete = true;
};

/// What branch and bound asks of a problem: a node stands for a set of solutions.
///
/// `root()` stands for all of them. `bound(node)` is at most the cost of each of a node's solutions; >= 0,
/// infinity where there are none. `branch(nodes, upper_bound, stop)` works on a batch, one answer each in
/// order, and may do so in parallel; solutions that cost `upper_bound` or more need not be kept.
template <typename P>
concept BranchingProblem = std::movable<typename P::Node> && std::copyable<typename P::Solution> &&
    requires(P& problem, const typename P::Node& node, const std::vector<typename P::Node>& nodes,
             const StopCondition& stop) {
  { problem.root() } -> std::same_as<typename P::Node>;
  { problem.bound(node) } -> std::convertible_to<double>;
  {
    problem.branch(nodes, 0.0, stop)
    } -> std::same_as<std::vector<Branching<typename P::Node, typename P::Solution>>>;
};

struct BranchAndBoundOptions {
  /// Stop when the incumbent costs at most w times the lower bound; finite, >= 1.
  double w = 1.0;
  /// Stop after so many nodes: the same stop on every machine.
  std::optional<std::uint64_t> max_expansions = std::nullopt;
  /// Stop with so many nodes in OPEN.
  std::size_t max_open = 5'000'000;
  /// Nodes worked on together. The search depends on it, so it must not depend on the number of threads.
  std::size_t batch = 8;

  /// Throws InvalidSetting naming the field and the value.
  void check() const {
    if (!(w >= 1.0) || !std::isfinite(w))
      throw InvalidSetting("w = " + std::to_string(w) + ": must be finite and at least 1");
    if (batch < 1 || batch > 4096)
      throw InvalidSetting("batch = " + std::to_string(batch) + ": must be in 1 .. 4096");
  }
};

namespace detail {

template <BranchingProblem P>
class BranchAndBound {
 public:
  using Node = typename P::Node;
  using Solution = typename P::Solution;

  BranchAndBound(P& problem, const BranchAndBoundOptions& options, const StopCondition& stop,
                 const SearchObserver<Solution>& observer)
      : problem_(problem), options_(options), stop_(stop), observer_(observer) {}

  SearchResult<Solution> run(std::optional<Incumbent<Solution>> initial) {
    incumbent_ = std::move(initial);
    add(problem_.root(), 0.0, 0);
    proven_ = lower_bound();
    while (true) {
      if (const auto reason = finished()) return result(*reason);
      if (const auto reason = interrupted()) return result(*reason);
      std::vector<Open> taken = take();
      std::vector<Node> nodes;
      for (Open& open : taken) nodes.push_back(std::move(open.node));
      auto branchings = problem_.branch(nodes, incumbent_cost(), stop_);
      if (branchings.size() != nodes.size()) throw std::logic_error("branch: not one answer for each node");
      bool complete = true;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (branchings[i].found) offer(std::move(*branchings[i].found));
        if (branchings[i].complete) continue;
        complete = false;
        taken[i].node = std::move(nodes[i]);  // stands for its children, which are not known
        put_back(std::move(taken[i]));
      }
      for (std::size_t i = 0; i < branchings.size(); ++i) {
        if (!branchings[i].complete) continue;
        ++counters_.expanded;
        counters_.generated += branchings[i].children.size();
        for (Node& child : branchings[i].children) add(std::move(child), taken[i].bound, taken[i].depth + 1);
      }
      prune();
      proven_ = std::max(proven_, lower_bound());
      if (!complete)
        return result(finished().value_or(stop_.cancelled() ? StopReason::cancelled : StopReason::time));
      if (observer_.on_expansion) observer_.on_expansion(progress());
    }
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  struct Open {
    double bound;
    std::uint32_t depth;
    std::uint64_t number;
    Node node;

    /// The heap's first: the lowest bound, then the deepest, then the oldest.
    bool operator<(const Open& other) const {
      if (bound != other.bound) return bound > other.bound;
      if (depth != other.depth) return depth < other.depth;
      return number > other.number;
    }
  };

  double incumbent_cost() const { return incumbent_ ? incumbent_->cost : infinity; }
  double lower_bound() const {
    return std::min(incumbent_cost(), open_.empty() ? infinity : open_.front().bound);
  }

  void add(Node node, double parent_bound, std::uint32_t depth) {
    const double own = problem_.bound(node);
    if (!(own >= 0.0)) throw std::logic_error("bound " + std::to_string(own) + ": must be >= 0");
    const double bound = std::max(parent_bound, own);
    if (bound >= incumbent_cost()) {
      ++counters_.pruned;
      return;
    }
    put_back({bound, depth, next_number_++, std::move(node)});
    counters_.peak_open = std::max(counters_.peak_open, open_.size());
  }

  void put_back(Open open) {
    open_.push_back(std::move(open));
    std::push_heap(open_.begin(), open_.end());
  }

  std::vector<Open> take() {
    std::size_t count = options_.batch;
    if (options_.max_expansions)
      count = static_cast<std::size_t>(
          std::min<std::uint64_t>(count, *options_.max_expansions - counters_.expanded));
    std::vector<Open> taken;
    while (taken.size() < count && !open_.empty()) {
      std::pop_heap(open_.begin(), open_.end());
      taken.push_back(std::move(open_.back()));
      open_.pop_back();
    }
    return taken;
  }

  /// Nodes that a better incumbent made useless go at once: they would only hold memory.
  void prune() {
    if (incumbent_cost() == pruned_at_) return;
    pruned_at_ = incumbent_cost();
    counters_.pruned += std::erase_if(open_, [&](const Open& open) { return open.bound >= pruned_at_; });
    std::make_heap(open_.begin(), open_.end());
  }

  void offer(Incumbent<Solution> found) {
    if (!(found.cost >= 0.0) || found.cost == infinity)
      throw std::logic_error("solution's cost " + std::to_string(found.cost) + ": must be finite and >= 0");
    if (found.cost >= incumbent_cost()) return;
    incumbent_ = std::move(found);
    if (observer_.on_incumbent) observer_.on_incumbent(*incumbent_, progress());
  }

  std::optional<StopReason> finished() const {
    if (incumbent_ && incumbent_->cost <= options_.w * lower_bound()) return StopReason::solved;
    if (open_.empty()) return StopReason::infeasible;
    return std::nullopt;
  }

  std::optional<StopReason> interrupted() const {
    return interruption(stop_, counters_.expanded, options_.max_expansions, open_.size(), options_.max_open);
  }

  SearchProgress progress() const {
    return {counters_.expanded, counters_.generated,
            incumbent_ ? std::optional(incumbent_->cost) : std::nullopt, std::min(proven_, incumbent_cost())};
  }

  SearchResult<Solution> result(StopReason reason) {
    SearchResult<Solution> r;
    r.lower_bound = lower_bound();
    r.reason = reason;
    r.counters = counters_;
    r.incumbent = std::move(incumbent_);
    return r;
  }

  P& problem_;
  const BranchAndBoundOptions& options_;
  const StopCondition& stop_;
  const SearchObserver<Solution>& observer_;

  std::vector<Open> open_;  // a heap
  std::uint64_t next_number_ = 0;
  double pruned_at_ = infinity;
  double proven_ = 0.0;  // what OPEN proved when it was last whole
  std::optional<Incumbent<Solution>> incumbent_;
  SearchCounters counters_;
};

}  // namespace detail

/// Best-first branch and bound. Works on the nodes with the lowest bounds, a batch at a time; the lowest
/// bound in OPEN is a lower bound on every solution not yet found, at any moment, and the search ends once
/// the incumbent costs at most w times that.
///
/// `initial` is a solution known beforehand. Deterministic: the same answers of the problem give the same
/// search. Throws InvalidSetting for options out of range; std::logic_error for a bound or a cost that is
/// negative or NaN.
template <BranchingProblem P>
SearchResult<typename P::Solution> branch_and_bound(
    P& problem, const BranchAndBoundOptions& options, const StopCondition& stop,
    std::optional<Incumbent<typename P::Solution>> initial = std::nullopt,
    const SearchObserver<typename P::Solution>& observer = {}) {
  options.check();
  if (initial && (!(initial->cost >= 0.0) || !std::isfinite(initial->cost)))
    throw std::logic_error("initial incumbent's cost " + std::to_string(initial->cost) +
                           ": must be finite and >= 0");
  return detail::BranchAndBound<P>(problem, options, stop, observer).run(std::move(initial));
}

}  // namespace perch
