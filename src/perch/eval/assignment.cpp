#include "perch/eval/assignment.hpp"

#include <algorithm>
#include <limits>

namespace perch {
namespace {

/// At most as many rows as columns: rows are taken in one after the other, each along the shortest path of
/// reduced costs that frees a column for it.
class Assignment {
 public:
  explicit Assignment(const Eigen::MatrixXd& costs)
      : costs_(costs),
        row_price_(Eigen::VectorXd::Zero(costs.rows())),
        column_price_(Eigen::VectorXd::Zero(costs.cols())),
        row_of_(static_cast<std::size_t>(costs.cols()), none) {
    for (Eigen::Index row = 0; row < costs.rows(); ++row) take_in(row);
  }

  /// The row of each column, or `none`.
  const std::vector<Eigen::Index>& row_of() const { return row_of_; }

  static constexpr Eigen::Index none = -1;

 private:
  void take_in(Eigen::Index new_row) {
    const std::size_t n = row_of_.size();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> distance(n, infinity);    // of the columns from the new row
    std::vector<Eigen::Index> previous(n, none);  // the column before, none: the new row itself
    std::vector<char> done(n, 0);
    Eigen::Index row = new_row, column = none;
    double reached = 0.0;
    do {
      Eigen::Index nearest = none;
      for (std::size_t j = 0; j < n; ++j) {
        if (done[j]) continue;
        const auto c = static_cast<Eigen::Index>(j);
        const double through = reached + costs_(row, c) - row_price_[row] - column_price_[c];
        if (through < distance[j]) {
          distance[j] = through;
          previous[j] = column;
        }
        if (nearest == none || distance[j] < distance[static_cast<std::size_t>(nearest)]) nearest = c;
      }
      column = nearest;
      reached = distance[static_cast<std::size_t>(column)];
      done[static_cast<std::size_t>(column)] = 1;
      row = row_of_[static_cast<std::size_t>(column)];
    } while (row != none);

    row_price_[new_row] += reached;
    for (std::size_t j = 0; j < n; ++j) {
      if (!done[j]) continue;
      const double less = reached - distance[j];
      column_price_[static_cast<Eigen::Index>(j)] -= less;
      if (row_of_[j] != none) row_price_[row_of_[j]] += less;
    }
    while (column != none) {
      const auto j = static_cast<std::size_t>(column);
      const Eigen::Index before = previous[j];
      row_of_[j] = before == none ? new_row : row_of_[static_cast<std::size_t>(before)];
      column = before;
    }
  }

  const Eigen::MatrixXd& costs_;
  Eigen::VectorXd row_price_, column_price_;  // their sums are the costs on pairs and below them elsewhere
  std::vector<Eigen::Index> row_of_;
};

}  // namespace

std::vector<std::optional<std::size_t>> cheapest_assignment(const Eigen::MatrixXd& costs) {
  std::vector<std::optional<std::size_t>> column_of(static_cast<std::size_t>(costs.rows()));
  const bool tall = costs.rows() > costs.cols();
  const Eigen::MatrixXd wide = tall ? Eigen::MatrixXd(costs.transpose()) : costs;
  const std::vector<Eigen::Index> row_of = Assignment(wide).row_of();
  for (std::size_t j = 0; j < row_of.size(); ++j) {
    if (row_of[j] == Assignment::none) continue;
    const auto i = static_cast<std::size_t>(row_of[j]);
    if (tall)
      column_of[j] = i;
    else
      column_of[i] = j;
  }
  return column_of;
}

}  // namespace perch
