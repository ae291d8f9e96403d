#include "perch/candidates/partial_bound.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace perch {
namespace {

constexpr int iterations = 30;  // of the Lagrangian bound, in each round
constexpr int rounds = 2;       // choices dropped in one make certain costs wider in the next

/// A rendered point of an option that shows beside what is placed.
struct VisiblePoint {
  std::uint32_t pixel;
  float z;
  bool explained;
};

/// The covering problem of the open slots beside what is placed. What is placed is an option of its own in a
/// last slot, for its unexplained points.
class PartialScene {
 public:
  PartialScene(const LocalizationProblem& problem, const CandidateSet& set, const Composite& placed,
               const std::vector<OpenSlot>& slots, CandidateMaker& maker)
      : problem_(problem), set_(set), placed_(placed), slots_(slots), maker_(maker) {
    window_ = placed.depth.window;
    for (const OpenSlot& slot : slots)
      for (const OpenSlot::Choice& choice : slot.choices) window_ = bounding(window_, set[choice.id].window);
  }

  /// False where the stop condition struck.
  bool see(const StopCondition& stop) {
    std::vector<char> explicable(problem_.observation().size(), 0);
    for (std::uint32_t slot = 0; slot < slots_.size(); ++slot)
      for (const OpenSlot::Choice& choice : slots_[slot].choices) {
        if (stop()) return false;
        const DepthPatch& patch = maker_.patch(set_[choice.id]);
        problem_.cost().change(placed_, patch, maker_.scratch());
        std::vector<Run> explained;
        for (const std::uint32_t p : maker_.scratch().gained) {
          append(explained, p);
          explicable[p] = 1;
        }
        add_option(slot, std::move(explained));
        ids_.push_back(choice.id);
        see_points(patch, maker_.scratch().appears);
      }
    number_points(explicable);
    add_option(static_cast<std::uint32_t>(slots_.size()), {});
    see_placed();
    for (const OpenSlot& slot : slots_) covering_.copies.push_back(slot.copies);
    covering_.copies.push_back(1);
    number_pixels();
    covering_.fixed =
        problem_.cost().charged_points() - placed_.observed_count - static_cast<std::int64_t>(points_.size());
    return true;
  }

  /// Hands over what see() made.
  Covering take_covering() { return std::move(covering_); }

  /// Splits what each option that is left leaves unexplained into B and U.
  void split_unexplained(Lagrangian& lagrangian) {
    find_nearest(lagrangian);
    for (std::size_t i = 0; i < visible_.size(); ++i)
      if (lagrangian.kept(i)) split(i, lagrangian);
  }

  /// Of all options but the last.
  CandidateId id(std::size_t option) const { return ids_[option]; }
  /// The points of I that some option explains.
  const std::vector<std::uint32_t>& points() const { return points_; }

 private:
  static constexpr std::uint32_t none = 0xffffffffU;
  /// The nearest explained points at a pixel, of two different slots; a slot with several copies counts as
  /// two.
  struct Nearest {
    float first = no_surface, second = no_surface;
    std::uint32_t slot = none;

    void add(float z, std::uint32_t of_slot, bool alone) {
      if (of_slot == slot) {
        first = std::min(first, z);
      } else if (z < first) {
        second = first;
        first = z;
        slot = of_slot;
      } else {
        second = std::min(second, z);
      }
      if (!alone) second = std::min(second, z);
    }
    bool may_hide(float z, std::uint32_t own_slot) const { return (slot == own_slot ? second : first) < z; }
  };

  void find_nearest(const Lagrangian& lagrangian) {
    const Covering& covering = lagrangian.covering();
    nearest_.assign(covering.pixels, Nearest());
    for (std::size_t i = 0; i < visible_.size(); ++i) {
      if (!lagrangian.kept(i)) continue;
      const std::uint32_t slot = covering.options[i].slot;
      const bool alone = covering.copies[slot] == 1;
      for (const VisiblePoint& point : visible_[i])
        if (point.explained) nearest_[point.pixel].add(point.z, slot, alone);
    }
  }

  void split(std::size_t option, Lagrangian& lagrangian) const {
    const std::uint32_t slot = lagrangian.covering().options[option].slot;
    std::vector<Run> certain, uncertain;
    for (const VisiblePoint& point : visible_[option])
      if (!point.explained)
        append(nearest_[point.pixel].may_hide(point.z, slot) ? uncertain : certain, point.pixel);
    lagrangian.set_unexplained(option, std::move(certain), std::move(uncertain));
  }

  void add_option(std::uint32_t slot, std::vector<Run> explained) {
    Covering::Option option;
    option.slot = slot;
    option.explained = std::move(explained);
    covering_.options.push_back(std::move(option));
    visible_.emplace_back();
  }

  std::uint32_t pixel(int u, int v) const {
    return static_cast<std::uint32_t>(v - window_.v0) * static_cast<std::uint32_t>(window_.width()) +
           static_cast<std::uint32_t>(u - window_.u0);
  }

  void see_points(const DepthPatch& patch, const BitWindow& appears) {
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u) {
        const float z = patch.at(u, v);
        if (z < placed_.depth.at_or_none(u, v) && problem_.cost().counts_at(u, v, z))
          visible_.back().push_back({pixel(u, v), z, appears.contains(u, v)});
      }
  }

  void see_placed() {
    const DepthPatch& depth = placed_.depth;
    for (int v = depth.window.v0; v < depth.window.v1; ++v)
      for (int u = depth.window.u0; u < depth.window.u1; ++u) {
        const float z = depth.at(u, v);
        if (z < no_surface && !placed_.explained[depth.index(u, v)])
          visible_.back().push_back({pixel(u, v), z, false});
      }
  }

  /// Points that some option explains are numbered in their order, so that runs stay runs.
  void number_points(const std::vector<char>& explicable) {
    std::vector<std::uint32_t> number(explicable.size() + 1, 0);
    for (std::size_t p = 0; p < explicable.size(); ++p) {
      number[p + 1] = number[p] + static_cast<std::uint32_t>(explicable[p]);
      if (explicable[p]) points_.push_back(static_cast<std::uint32_t>(p));
    }
    covering_.points = points_.size();
    for (Covering::Option& option : covering_.options)
      for (Run& run : option.explained) run = {number[run.first], number[run.last]};
  }

  /// Only pixels that some option leaves unexplained take part.
  void number_pixels() {
    std::vector<std::uint32_t> number(
        static_cast<std::size_t>(window_.width()) * static_cast<std::size_t>(window_.height()), none);
    for (const auto& points : visible_)
      for (const VisiblePoint& point : points)
        if (!point.explained) number[point.pixel] = 0;
    std::uint32_t next = 0;
    for (std::uint32_t& n : number)
      if (n != none) n = next++;
    covering_.pixels = next;
    for (std::size_t i = 0; i < visible_.size(); ++i) {
      for (VisiblePoint& point : visible_[i]) point.pixel = number[point.pixel];
      std::erase_if(visible_[i], [](const VisiblePoint& point) { return point.pixel == none; });
      for (const VisiblePoint& point : visible_[i])
        if (point.explained) append(covering_.options[i].relieved, point.pixel);
    }
  }

  const LocalizationProblem& problem_;
  const CandidateSet& set_;
  const Composite& placed_;
  const std::vector<OpenSlot>& slots_;
  CandidateMaker& maker_;
  Window window_;
  Covering covering_;
  std::vector<CandidateId> ids_;
  std::vector<std::vector<VisiblePoint>> visible_;  // of each option
  std::vector<std::uint32_t> points_;
  std::vector<Nearest> nearest_;
};

}  // namespace

PartialBound bound_partial_scene(const LocalizationProblem& problem, const CandidateSet& set,
                                 const Composite& placed, const std::vector<OpenSlot>& slots,
                                 const std::vector<Lagrangian::Weight>& point_weights,
                                 std::int64_t upper_bound, CandidateMaker& maker, const StopCondition& stop) {
  const SerialExecutor serial;
  PartialBound result, interrupted;
  interrupted.complete = false;
  PartialScene scene(problem, set, placed, slots, maker);
  if (!scene.see(stop)) return interrupted;
  Lagrangian lagrangian(scene.take_covering());
  for (std::size_t i = 0; i < scene.points().size(); ++i)
    lagrangian.set_point_weight(i, point_weights[scene.points()[i]]);
  const std::size_t options = lagrangian.covering().options.size();
  for (int round = 0; round < rounds; ++round) {
    scene.split_unexplained(lagrangian);
    lagrangian.share_pixels();
    const std::size_t before = lagrangian.kept_count();
    lagrangian.improve(iterations, upper_bound, static_cast<double>(upper_bound), serial, stop);
    if (stop()) return interrupted;
    if (lagrangian.lower_bound() >= upper_bound || lagrangian.kept_count() == before) break;
  }
  result.lower_bound = lagrangian.lower_bound();
  result.base = lagrangian.base();
  if (result.lower_bound >= upper_bound) return result;
  for (const OpenSlot& slot : slots) result.slots.push_back({slot.copies, slot.origin, {}});
  for (std::size_t i = 0; i + 1 < options; ++i)
    if (lagrangian.kept(i))
      result.slots[lagrangian.covering().options[i].slot].choices.push_back(
          {scene.id(i), lagrangian.reduced_cost(i)});
  for (std::size_t s = 0; s < slots.size(); ++s) {
    auto& choices = result.slots[s].choices;
    std::sort(choices.begin(), choices.end(), [](const OpenSlot::Choice& a, const OpenSlot::Choice& b) {
      return std::tie(a.reduced_cost, a.id) < std::tie(b.reduced_cost, b.id);
    });
    for (int copy = 0; copy < slots[s].copies; ++copy) result.best.push_back(scene.id(lagrangian.best()[s]));
  }
  return result;
}

}  // namespace perch
