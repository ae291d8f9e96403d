#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "perch/cost/explanation_cost.hpp"
#include "perch/observation/run.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// The cost of an object as if it stood alone.
struct LoneValue {
  std::int64_t points = 0;       ///< rendered points that count
  std::int64_t unexplained = 0;  ///< of these, unexplained by I
  std::int64_t exposed = 0;      ///< of those, the ones that no nearer observed point could be hiding
  std::int64_t explained_count = 0;
  std::vector<Run> explained;  ///< points of I within delta of its rendered points
  /// Pixels (row-major) whose point is unexplained, and so is every point nearer on the ray.
  std::vector<Run> certain;
  std::vector<Run> uncertain;  ///< pixels whose point is unexplained, but a nearer one may not be
  std::vector<Run> shown;      ///< pixels whose point is explained
};

/// Values objects alone or beside others: ExplanationCost::change, counts_with and add, to the point, in one
/// pass over the rendered pixels and one over the points of I around them, several at a time. Holds scratch
/// memory: one a thread.
class LoneCost {
 public:
  explicit LoneCost(const ExplanationCost& cost);

  /// Writes into `value`, whose memory is reused.
  void value(const DepthPatch& patch, LoneValue& value);
  /// J's counts after the patch is added to a composite; empty where J is more than `most`, which takes less
  /// work to find out.
  std::optional<CostCounts> counts_with(const Composite& composite, const DepthPatch& patch,
                                        std::int64_t most);

  /// As ExplanationCost::add.
  void add(Composite& composite, const DepthPatch& patch);

 private:
  /// Takes in the patch, or what of it shows in front of `composite`.
  void load(const DepthPatch& patch, const Composite* composite);
  /// False, and the value incomplete, where more rendered points than this are unexplained.
  bool value_loaded(const DepthPatch& patch, LoneValue& value, std::int64_t most_unexplained);
  /// The most points of I that the composite does not explain and the patch may.
  std::int64_t most_gained(const Composite& composite) const;
  /// What the patch changes of the composite's counts; false, and these incomplete, where J is sure to become
  /// more than `most`.
  bool change(const Composite& composite, const DepthPatch& patch, std::int64_t most, CostCounts& counts);
  /// Counts the composite's unexplained pixels that the patch hides and notes the explained ones in hides_.
  std::int64_t find_hidden(const Composite& composite, const DepthPatch& patch);
  /// Writes into lost_ the points of I that only hidden pixels of the composite explain.
  void find_lost(const Composite& composite);

  /// A row of rendered_ as seen from column 0 of the image.
  float* rendered_row(int v) {
    return rendered_.data() + static_cast<std::size_t>(v - area_.v0) * pitch_ + cost_.index().reach() -
           area_.u0;
  }

  const ExplanationCost& cost_;
  float ball_reach_;  ///< pixels that a ball of radius delta reaches from its middle, at a distance of 1 m
  LoneValue beside_;
  BitWindow hides_;
  Window hidden_;       ///< that holds hides_
  PointSet explained_;  ///< points of I: beside_.explained
  std::vector<std::uint32_t> lost_;
  Window area_;  ///< pixels whose points the patch may explain
  std::size_t pitch_ = 0;
  std::vector<float> rendered_;            ///< depths in area_; after the first pass only explained ones
  std::vector<float> nearest_, farthest_;  ///< explained depths around each block of pixels
  std::vector<float> row_nearest_, row_farthest_;
};

}  // namespace perch
