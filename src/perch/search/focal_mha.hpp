#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/core/stop.hpp"
#include "perch/search/lazy_queue.hpp"
#include "perch/search/search_problem.hpp"
#include "perch/search/search_result.hpp"
#include "perch/search/state_store.hpp"

namespace perch {

struct FocalMhaOptions {
  /// The answer costs at most w times the optimum, and FOCAL holds the states with f <= w * min f; finite,
  /// >= 1.
  double w = 3.0;
  /// Stop after so many expansions: the same stop on every machine.
  std::optional<std::uint64_t> max_expansions = std::nullopt;
  /// Stop with so many states stored; looked at between expansions.
  std::size_t max_states = 20'000'000;
  /// Go on after that until the incumbent is proven optimal or something else stops the search.
  bool anytime = false;

  /// Throws InvalidSetting naming the field and the value.
  void check() const {
    if (!(w >= 1.0) || !std::isfinite(w))
      throw InvalidSetting("w = " + std::to_string(w) + ": must be finite and at least 1");
    if (max_states < 1 || max_states > (std::size_t{1} << 31))
      throw InvalidSetting("max_states = " + std::to_string(max_states) + ": must be in 1 .. 2^31");
  }
};

/// A guess at the cost that is left from a state to the nearest goal: >= 0, may be infinite, never NaN.
template <typename State>
using Heuristic = std::function<double(const State&)>;

template <typename State>
struct Heuristics {
  /// For the anchor queue: never above the true cost that is left; infinity says that no goal can be reached.
  /// Need not be consistent. Asked at most once a state, never for a goal.
  Heuristic<State> admissible = [](const State&) { return 0.0; };
  /// One queue each. Only their order counts; infinity means last. Asked at most once a state, when it enters
  /// FOCAL.
  std::vector<Heuristic<State>> inadmissible;
};

namespace detail {

template <SearchProblem P>
class FocalMha {
 public:
  using State = typename P::State;

  FocalMha(P& problem, const Heuristics<State>& heuristics, const FocalMhaOptions& options,
           const StopCondition& stop, const SearchObserver<State>& observer)
      : problem_(problem),
        heuristics_(heuristics),
        options_(options),
        stop_(stop),
        observer_(observer),
        focal_(heuristics.inadmissible.size()) {}

  SearchResult<State> run(std::optional<Incumbent<State>> initial) {
    incumbent_ = std::move(initial);
    open_root();
    update_bound();
    while (true) {
      if (const auto reason = finished()) return result(*reason);
      if (const auto reason = interrupted()) return result(*reason);
      admit_to_focal();
      const bool from_anchor = turn_ == 0;
      const Index index = choose();
      Expansion<State> expansion = problem_.expand(states_[index].state, stop_);
      const auto first_other = goals_first(expansion.edges);
      for (auto edge = expansion.edges.begin(); edge != first_other; ++edge) offer(index, *edge);
      if (!expansion.complete) {
        // Successors are missing, so the state stands for them: it stays in OPEN, and so does the bound.
        update_bound();
        return result(finished().value_or(stop_.cancelled() ? StopReason::cancelled : StopReason::time));
      }
      close(index, from_anchor);
      for (auto edge = first_other; edge != expansion.edges.end(); ++edge) relax(index, std::move(*edge));
      update_bound();
      turn_ = (turn_ + 1) % (focal_.size() + 1);
      if (observer_.on_expansion) observer_.on_expansion(progress());
    }
  }

 private:
  using Store = StateStore<State>;
  using Index = typename Store::Index;
  using Node = typename Store::Node;
  using Edges = std::vector<Edge<State>>;
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  double incumbent_cost() const { return incumbent_ ? incumbent_->cost : infinity; }
  // Leads to nothing better than the incumbent, or to no goal at all: dead ends have f = infinity.
  bool hopeless(double f) const { return f >= incumbent_cost(); }
  double lower_bound() const { return std::min(incumbent_cost(), open_bound_); }

  void open_root() {
    State root = problem_.root();
    const bool is_goal = problem_.is_goal(root);
    const Index index = states_.add(std::move(root));
    if (is_goal) return offer_path(states_[index].state, {index}, 0.0);
    states_[index].h = states_[index].f = admissible(states_[index].state);
    place(index);
  }

  /// min f over OPEN. It never falls: by pathmax no successor's f is below that of the state expanded.
  void update_bound() {
    const QueueEntry* first = anchor_.top(alive());
    open_bound_ = first ? first->key : infinity;
  }

  std::optional<StopReason> finished() const {
    const double factor = options_.anytime ? 1.0 : options_.w;
    if (incumbent_ && incumbent_->cost <= factor * lower_bound()) return StopReason::solved;
    if (open_count_ == 0) return StopReason::infeasible;  // with an incumbent the bound is its cost
    return std::nullopt;
  }

  std::optional<StopReason> interrupted() const {
    return interruption(stop_, counters_.expanded, options_.max_expansions, states_.size(),
                        options_.max_states);
  }

  /// FOCAL is OPEN's states with f <= w * min f. As min f never falls, none leaves it but by a change of its
  /// own f, and `waiting_` holds the others in the order in which they will enter.
  void admit_to_focal() {
    if (focal_.empty()) return;
    focal_limit_ = options_.w * open_bound_;
    for (const QueueEntry* entry = waiting_.top(alive()); entry && entry->key <= focal_limit_;
         entry = waiting_.top(alive())) {
      const Index index = entry->index;
      waiting_.pop();
      push_focal(index);
    }
  }

  /// Each queue in turn, the anchor first. No queue is empty: the anchor's first state is in FOCAL as w >= 1.
  Index choose() {
    LazyQueue& queue = turn_ == 0 ? anchor_ : focal_[turn_ - 1];
    return queue.top(alive())->index;
  }

  typename Edges::iterator goals_first(Edges& edges) {
    counters_.generated += edges.size();
    for (const auto& edge : edges)
      if (!(edge.cost >= 0.0) || edge.cost == infinity)
        throw std::logic_error("edge cost " + std::to_string(edge.cost) + ": must be finite and >= 0");
    return std::stable_partition(edges.begin(), edges.end(), [this](const Edge<State>& edge) -> bool {
      return problem_.is_goal(edge.state);
    });
  }

  void close(Index index, bool from_anchor) {
    Node& node = states_[index];
    remove_from_open(node);
    node.expanded = true;
    ++counters_.expanded;
    ++(from_anchor ? counters_.expanded_anchor : counters_.expanded_inadmissible);
  }

  /// A goal behind `parent`: the new incumbent if it is cheaper.
  void offer(Index parent, const Edge<State>& edge) {
    if (hopeless(states_[parent].g + edge.cost)) {
      ++counters_.pruned;
      return;
    }
    // An ancestor may have found a cheaper path to itself since: the goal costs what its path costs now.
    auto path = states_.path_to(parent);
    double cost = 0.0;
    for (const Index index : path) cost += states_[index].edge_cost;
    offer_path(edge.state, std::move(path), cost + edge.cost);
  }

  void offer_path(const State& goal, std::vector<Index> path, double cost) {
    if (hopeless(cost)) return;
    incumbent_ = Incumbent<State>{goal, cost};
    incumbent_path_ = std::move(path);
    if (observer_.on_incumbent) observer_.on_incumbent(*incumbent_, progress());
  }

  /// A state that is no goal, behind `parent`.
  void relax(Index parent, Edge<State>&& edge) {
    const Node& from = states_[parent];
    const double g = from.g + edge.cost;
    if (hopeless(std::max(g, from.f))) {
      ++counters_.pruned;
      return;
    }
    const auto known = states_.find(edge.state);
    const Index index = known ? *known : states_.add(std::move(edge.state));
    Node& node = states_[index];
    if (!known) node.h = admissible(node.state);
    // Pathmax: what is left at the parent is at most this edge and what is left here. That holds by
    // whichever path the state is reached, so that a dearer path may teach as well.
    node.h = std::max(node.h, from.h - edge.cost);
    if (known && g >= node.g) {
      ++counters_.duplicates;
      const double f = std::max(node.g + node.h, g == node.g ? from.f : 0.0);
      if (!node.open || f <= node.f) return;
      node.f = f;
    } else {
      node.g = g;
      node.f = std::max(g + node.h, from.f);
      node.parent = parent;
      node.edge_cost = edge.cost;
    }
    place(index);
  }

  /// Puts a state into OPEN, or moves it there, by its new f, unless it can't lead to anything better.
  void place(Index index) {
    Node& node = states_[index];
    if (hopeless(node.f)) {
      ++counters_.pruned;
      if (node.open) remove_from_open(node);
      return;
    }
    ++node.version;
    if (!node.open) {
      node.open = true;
      counters_.peak_open = std::max(counters_.peak_open, ++open_count_);
      if (node.expanded) ++counters_.reopened;
    }
    anchor_.push({node.f, -node.g, index, node.version}, alive(), open_count_);
    if (focal_.empty()) return;
    if (node.f <= focal_limit_)
      push_focal(index);
    else
      waiting_.push({node.f, 0.0, index, node.version}, alive(), open_count_);
  }

  void remove_from_open(Node& node) {
    ++node.version;
    node.open = false;
    --open_count_;
  }

  void push_focal(Index index) {
    Node& node = states_[index];
    if (!node.ranked) {
      node.ranks = static_cast<std::uint32_t>(ranks_.size() / focal_.size());
      node.ranked = true;
      for (const auto& heuristic : heuristics_.inadmissible)
        ranks_.push_back(checked(heuristic(node.state), "inadmissible heuristic"));
    }
    for (std::size_t i = 0; i < focal_.size(); ++i) {
      const double rank = ranks_[node.ranks * focal_.size() + i];
      focal_[i].push({rank, node.f, index, node.version}, alive(), open_count_);
    }
  }

  auto alive() const {
    return [this](const QueueEntry& entry) { return states_[entry.index].version == entry.version; };
  }

  double admissible(const State& state) const {
    return checked(heuristics_.admissible(state), "admissible heuristic");
  }

  static double checked(double value, const char* what) {
    if (!(value >= 0.0))
      throw std::logic_error(std::string(what) + " = " + std::to_string(value) + ": must be >= 0");
    return value;
  }

  SearchProgress progress() const {
    return {counters_.expanded, counters_.generated,
            incumbent_ ? std::optional(incumbent_->cost) : std::nullopt, lower_bound()};
  }

  SearchResult<State> result(StopReason reason) {
    SearchResult<State> r;
    r.lower_bound = lower_bound();
    r.reason = reason;
    r.counters = counters_;
    for (const Index index : incumbent_path_) r.path.push_back(states_[index].state);
    if (!r.path.empty() && !(r.path.back() == incumbent_->state)) r.path.push_back(incumbent_->state);
    r.incumbent = std::move(incumbent_);
    return r;
  }

  P& problem_;
  const Heuristics<State>& heuristics_;
  const FocalMhaOptions& options_;
  const StopCondition& stop_;
  const SearchObserver<State>& observer_;

  Store states_;
  LazyQueue anchor_;              // OPEN by f, then the larger g
  std::vector<LazyQueue> focal_;  // FOCAL by one inadmissible heuristic each, then by f
  LazyQueue waiting_;             // OPEN without FOCAL, by f; unused without inadmissible heuristics
  std::vector<double> ranks_;     // the inadmissible values of the states that were ever in FOCAL
  std::size_t open_count_ = 0;
  double open_bound_ = 0.0;
  double focal_limit_ = 0.0;
  std::size_t turn_ = 0;
  std::optional<Incumbent<State>> incumbent_;
  std::vector<Index> incumbent_path_;  // root to the incumbent's parent; frozen when it was found
  SearchCounters counters_;
};

}  // namespace detail

/// Focal-MHA* (Narayanan, Aine and Likhachev: "Improved Multi-Heuristic A* for Searching with Uncalibrated
/// Heuristics", SoCS 2015). The anchor queue, ordered by f = g + h with an admissible h, and each
/// inadmissible heuristic take turns to choose the state of OPEN to expand; the latter only among those with
/// f <= w * (min f over OPEN).
///
/// Unlike the paper's, h need not be consistent, and every state reached by a strictly cheaper path is put
/// back into OPEN, whichever queue expanded it before. So min f over OPEN is a lower bound on every goal
/// not yet found, at any moment, and the search ends once the incumbent costs at most w times the bound
/// (anytime: at most the bound). Bounds are as exact as the sums g + h: with integer costs and h <= the true
/// cost there is no rounding.
///
/// `initial` is a goal known beforehand and its cost. States that can't lead to a cheaper one are pruned. It
/// may lie outside the graph: what is proven then holds for the graph's goals and this one together.
///
/// Deterministic: the same answers of problem and heuristics give the same search.
/// Throws InvalidSetting for options out of range; std::logic_error for an edge cost that is negative, NaN or
/// infinite, a heuristic value that is negative or NaN, or an `initial` that is no goal or has such a cost.
template <SearchProblem P>
SearchResult<typename P::State> focal_mha(P& problem, const Heuristics<typename P::State>& heuristics,
                                          const FocalMhaOptions& options, const StopCondition& stop,
                                          std::optional<Incumbent<typename P::State>> initial = std::nullopt,
                                          const SearchObserver<typename P::State>& observer = {}) {
  options.check();
  if (initial && (!(initial->cost >= 0.0) || !std::isfinite(initial->cost)))
    throw std::logic_error("initial incumbent's cost " + std::to_string(initial->cost) +
                           ": must be finite and >= 0");
  if (initial && !problem.is_goal(initial->state)) throw std::logic_error("initial incumbent: no goal");
  return detail::FocalMha<P>(problem, heuristics, options, stop, observer).run(std::move(initial));
}

}  // namespace perch
