#pragma once

#include <cstdint>
#include <vector>

#include "perch/candidates/candidate_set.hpp"
#include "perch/candidates/lagrangian.hpp"
#include "perch/core/summed_area.hpp"

namespace perch {

/// The Lagrangian bound (see Lagrangian) with weights that are the same all over a block of pixels. These are
/// weights like any other, so the bound holds, and what a candidate is worth by them takes a few counts a
/// block. Blocks lie in a grid over the image; slots are kinds.
class CoarseDual {
 public:
  using Weight = Lagrangian::Weight;

  /// Keeps a reference to the problem.
  explicit CoarseDual(const LocalizationProblem& problem);

  /// Takes in the candidates of the set from the number of those taken in on.
  void add(const CandidateSet& set, const Executor& executor);
  /// Improves the weights by a subgradient method until the bound over the candidates taken in reaches
  /// `enough`, `iterations` at most. Every kind has a candidate. \param aim what the optimum may cost.
  void ascend(int iterations, std::int64_t aim, double enough, const Executor& executor,
              const StopCondition& stop);

  // At the weights. A scene of any k_m objects of each kind m, taken in or not, costs at least constant -
  // the sum of what they are worth; one that explains the points E and is seen in a window is worth at most
  // the sum of point_weights() over E + relief(m, window).
  Weight constant() const;
  /// Of each kind: the most that one of its candidates is worth.
  const std::vector<Weight>& largest() const { return largest_; }
  /// mu of each point of I.
  std::vector<Weight> point_weights() const;
  Weight relief(std::size_t kind, const Window& window) const;
  /// beta and upsilon of a pixel (row-major).
  Lagrangian::PixelWeight pixel_weight(std::size_t kind, std::uint32_t pixel) const;

 private:
  /// Counts of a candidate's pixels and points in the blocks of its window, in four planes.
  struct Counts {
    std::size_t kind = 0;
    int column = 0, row = 0, columns = 0, rows = 0;  ///< of blocks; columns are a multiple of lane_count
    std::vector<std::uint8_t> explained, certain, uncertain, relieved;
  };
  /// Weights of the blocks in units of 1 / coarse_one, and the slopes of the bound.
  struct Charges {
    std::vector<std::int32_t> certain, uncertain;
    std::vector<std::int32_t> best_certain, best_uncertain;
    std::vector<std::int32_t> relief;  ///< sum_n k_n upsilon_n - upsilon
    std::vector<int> certain_slope, uncertain_slope;
  };

  struct Place {
    std::uint16_t column, row;
  };

  std::size_t block_at(int column, int row) const {
    return static_cast<std::size_t>(row) * pitch_ + static_cast<std::size_t>(column);
  }
  Counts counts_of(const Candidate& candidate) const;
  void value_all(const Executor& executor);
  bool step(const std::vector<std::size_t>& best, double rise);
  void make_feasible(std::size_t block);
  void update_relief(std::size_t block);
  void sum_relief();
  void remember();
  void recall();

  const LocalizationProblem& problem_;
  int width_;           ///< of the image
  int columns_, rows_;  ///< of blocks
  std::size_t pitch_;   ///< of blocks, from one row to the next
  std::vector<Place> block_of_point_;
  std::vector<int> points_;                  ///< of I, by block
  std::vector<std::uint32_t> with_points_;   ///< blocks; elsewhere mu does not matter
  std::vector<std::uint32_t> ever_charged_;  ///< blocks; elsewhere charges are those of the start
  std::vector<char> charged_;                ///< of each block: in ever_charged_
  std::vector<Counts> candidates_;
  std::vector<Weight> values_;
  std::vector<Weight> largest_;
  std::vector<std::int32_t> mu_, best_mu_;
  std::vector<int> mu_slope_;
  std::vector<Charges> charges_;  ///< of each kind
  std::vector<std::uint32_t> moved_;
  std::vector<char> touched_;
  std::vector<SummedArea> relief_;  ///< of each kind, over blocks
};

}  // namespace perch
