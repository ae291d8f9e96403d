#pragma once

#include <cstdint>
#include <vector>

#include "perch/cost/bit_window.hpp"
#include "perch/cost/cost_settings.hpp"
#include "perch/cost/counted_depths.hpp"
#include "perch/observation/delta_index.hpp"
#include "perch/observation/observation.hpp"
#include "perch/observation/point_set.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// The two terms of the explanation cost J, counts of points (paper, eq. (1) to (3)).
struct CostCounts {
  std::int64_t observed = 0;  ///< J_observed: points of I unexplained by R
  std::int64_t rendered = 0;  ///< J_rendered: points of R unexplained by I

  std::int64_t total() const { return observed + rendered; }
  friend bool operator==(const CostCounts&, const CostCounts&) = default;
};

/// R_j, the nearest surface of the objects placed so far, and what it explains.
struct Composite {
  DepthPatch depth;                     ///< R_j; no_surface where nothing counts
  std::vector<std::uint8_t> explained;  ///< of each pixel of `depth`: within delta of I
  PointSet observed;                    ///< the points of I within delta of R_j; none where they cost nothing
  std::int64_t observed_count = 0;      ///< size of `observed`
  std::int64_t points = 0;              ///< |R_j|
  std::int64_t unexplained = 0;         ///< points of R_j unexplained by I
};

/// Widens the composite's window to one that also holds `needed`.
void enlarge(Composite& composite, const Window& needed);

/// What changes when a patch is added to a composite. Scratch memory, one a thread.
struct CostChange {
  std::int64_t points = 0;            ///< rendered points more
  std::int64_t unexplained = 0;       ///< unexplained rendered points more (or less)
  std::vector<std::uint32_t> gained;  ///< points of I that become explained, ascending
  std::vector<std::uint32_t> lost;    ///< points of I whose explanation is hidden, ascending
  BitWindow appears;                  ///< pixels of the patch that show and are explained
  BitWindow hides;                    ///< explained pixels of the composite that the patch hides
};

/// Counts the flat explanation cost J = J_observed + J_rendered of composites, exactly, in time proportional
/// to the window of the patch that is added.
class ExplanationCost {
 public:
  /// Keeps references. \param index of the same delta as the settings.
  ExplanationCost(const Observation& observation, const DeltaIndex& index, const CostSettings& settings);

  const Observation& observation() const { return observation_; }
  const DeltaIndex& index() const { return index_; }

  /// The composite of no objects.
  Composite empty() const;
  CostCounts counts(const Composite& composite) const;
  /// What adding the patch would change.
  void change(const Composite& composite, const DepthPatch& patch, CostChange& change) const;
  /// counts() after adding the patch.
  CostCounts counts_with(const Composite& composite, const DepthPatch& patch, CostChange& scratch) const;
  void add(Composite& composite, const DepthPatch& patch, CostChange& scratch) const;

  bool counts_everywhere() const { return counted_.everywhere(); }
  /// False where a rendered point is left out of R.
  bool counts_at(int u, int v, float z) const { return counted_.counts(u, v, z); }
  /// How many points of I cost 1 each as long as they are unexplained: all, or none where
  /// they may belong to clutter and the settings say so.
  std::int64_t charged_points() const {
    return charges_points_ ? static_cast<std::int64_t>(observation_.size()) : 0;
  }
  bool charges_points() const { return charges_points_; }

 private:
  void change_rendered(const Composite& composite, const DepthPatch& patch, CostChange& change) const;
  void change_observed(const Composite& composite, const DepthPatch& patch, CostChange& change) const;

  const Observation& observation_;
  const DeltaIndex& index_;
  CountedDepths counted_;
  bool charges_points_;
};

}  // namespace perch
