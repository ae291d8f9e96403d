#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

namespace perch {

/// Gives each row of a matrix of costs at most one column and each column to at most one row, min(rows,
/// columns) of them in all, at the least sum of costs: the Hungarian method by shortest augmenting paths,
/// O(rows^2 columns) for rows <= columns (Jonker and Volgenant 1987). \param costs finite.
/// \return for each row its column; empty for the rows that are left over where there are fewer columns.
std::vector<std::optional<std::size_t>> min_cost_assignment(const Eigen::MatrixXd& costs);

}  // namespace perch
