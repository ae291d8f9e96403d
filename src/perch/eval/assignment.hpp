#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace perch {

/// Which column each row is given so that the sum of the costs is least: as many pairs as the smaller side
/// has, each row and column in one at most; empty for a row without one. \param costs finite. O(n^3), the
/// Hungarian method with shortest augmenting paths (Kuhn 1955; Jonker and Volgenant 1987).
std::vector<std::optional<std::size_t>> cheapest_assignment(const Eigen::MatrixXd& costs);

}  // namespace perch
