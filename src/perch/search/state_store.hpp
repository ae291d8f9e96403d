#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <unordered_set>
#include <utility>
#include <vector>

namespace perch::detail {

/// A state and the cheapest path to it so far.
template <typename State>
struct SearchNode {
  State state;
  double g = 0.0;            ///< cost of the cheapest path so far
  double h = 0.0;            ///< admissible: no goal is nearer than this, by what all paths so far have shown
  double f = 0.0;            ///< no goal behind this path costs less; never below the parent's f (pathmax)
  double edge_cost = 0.0;    ///< of the path's last edge
  std::uint32_t parent = 0;  ///< the root's is itself
  std::uint32_t version = 0;
  std::uint32_t ranks = 0;  ///< where its inadmissible values lie, once `ranked`
  bool ranked = false;
  bool open = false;
  bool expanded = false;  ///< at least once, maybe by a dearer path
};

/// Every state of a search, once each, found by value or by number. The root is number 0; references hold
/// for the life of the store.
template <typename State>
class StateStore {
 public:
  using Index = std::uint32_t;
  using Node = SearchNode<State>;

  StateStore() : index_(0, Hash{&nodes_}, Equal{&nodes_}) {}
  StateStore(const StateStore&) = delete;
  StateStore& operator=(const StateStore&) = delete;

  std::optional<Index> find(const State& state) const {
    const auto found = index_.find(state);
    return found == index_.end() ? std::nullopt : std::optional<Index>(found->index);
  }

  /// Precondition: find(state) is empty.
  Index add(State state) {
    const auto index = static_cast<Index>(nodes_.size());
    nodes_.push_back(Node{.state = std::move(state)});
    index_.insert(Slot{index});
    return index;
  }

  Node& operator[](Index index) { return nodes_[index]; }
  const Node& operator[](Index index) const { return nodes_[index]; }
  std::size_t size() const { return nodes_.size(); }

  /// Root to `index` along the parents. Parents form a tree: one is replaced only by a strictly cheaper path,
  /// and no edge cost is negative.
  std::vector<Index> path_to(Index index) const {
    std::vector<Index> path{index};
    while (path.back() != 0) path.push_back(nodes_[path.back()].parent);
    return {path.rbegin(), path.rend()};
  }

 private:
  // A set of numbers that is looked up by state, so that each state is stored once, in its node. The number
  // has a type of its own because a State may be an integer.
  struct Slot {
    Index index;
  };
  struct Hash {
    using is_transparent = void;
    const std::deque<Node>* nodes;
    std::size_t operator()(const State& state) const { return std::hash<State>{}(state); }
    std::size_t operator()(Slot slot) const { return (*this)((*nodes)[slot.index].state); }
  };
  struct Equal {
    using is_transparent = void;
    const std::deque<Node>* nodes;
    bool operator()(const State& a, Slot b) const { return a == (*nodes)[b.index].state; }
    bool operator()(Slot a, const State& b) const { return (*nodes)[a.index].state == b; }
    bool operator()(Slot a, Slot b) const { return a.index == b.index; }
  };

  std::deque<Node> nodes_;
  std::unordered_set<Slot, Hash, Equal> index_;
};

}  // namespace perch::detail
