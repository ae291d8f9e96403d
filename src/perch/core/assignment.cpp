#include "perch/core/assignment.hpp"

#include <limits>

namespace perch {
namespace {

using Index = Eigen::Index;

/// The row of each column, -1 for none; no more rows than columns.
std::vector<Index> rows_of_columns(const Eigen::MatrixXd& costs) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const Index rows = costs.rows(), columns = costs.cols();
  // Dual prices: costs(i, j) - row_price(i) - column_price(j) is never negative, and 0 for what is assigned.
  Eigen::VectorXd row_price = Eigen::VectorXd::Zero(rows), column_price = Eigen::VectorXd::Zero(columns);
  std::vector<Index> row_of(static_cast<std::size_t>(columns), -1);
  const auto owner = [&](Index column) -> Index& { return row_of[static_cast<std::size_t>(column)]; };
  for (Index added = 0; added < rows; ++added) {
    // Dijkstra from the new row over reduced costs to the nearest column that is still free.
    Eigen::VectorXd distance = Eigen::VectorXd::Constant(columns, infinity);
    std::vector<Index> before(static_cast<std::size_t>(columns), -1);
    std::vector<char> done(static_cast<std::size_t>(columns), 0);
    std::vector<Index> settled;
    Index row = added, last = -1;
    double travelled = 0.0;
    while (true) {
      Index nearest = -1;
      for (Index j = 0; j < columns; ++j) {
        if (done[static_cast<std::size_t>(j)]) continue;
        const double through = travelled + costs(row, j) - row_price(row) - column_price(j);
        if (through < distance(j)) {
          distance(j) = through;
          before[static_cast<std::size_t>(j)] = last;
        }
        if (nearest < 0 || distance(j) < distance(nearest)) nearest = j;
      }
      travelled = distance(nearest);
      last = nearest;
      if (owner(nearest) < 0) break;
      done[static_cast<std::size_t>(nearest)] = 1;
      settled.push_back(nearest);
      row = owner(nearest);
    }
    row_price(added) += travelled;
    for (const Index j : settled) {
      row_price(owner(j)) += travelled - distance(j);
      column_price(j) -= travelled - distance(j);
    }
    // Hand the columns of the path on, from its end.
    while (last >= 0) {
      const Index previous = before[static_cast<std::size_t>(last)];
      owner(last) = previous < 0 ? added : owner(previous);
      last = previous;
    }
  }
  return row_of;
}

}  // namespace

std::vector<std::optional<std::size_t>> min_cost_assignment(const Eigen::MatrixXd& costs) {
  std::vector<std::optional<std::size_t>> column_of(static_cast<std::size_t>(costs.rows()));
  const bool wide = costs.rows() <= costs.cols();
  const std::vector<Index> assigned = rows_of_columns(wide ? costs : costs.transpose());
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    if (assigned[i] < 0) continue;
    const auto other = static_cast<std::size_t>(assigned[i]);
    if (wide)
      column_of[other] = i;
    else
      column_of[i] = other;
  }
  return column_of;
}

}  // namespace perch
