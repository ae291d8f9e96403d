#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/model/symmetry.hpp"

// Errors of an estimated pose of a model, by their published definitions (docs/evaluation.md). Vertices are
// in the model's frame, metres; both poses map them into the same frame, which for `mspd` is the camera's.
// The vertices must not be none.
namespace perch {

using Vertices = std::span<const Eigen::Vector3f>;

/// Largest distance between two vertices, metres.
double diameter(Vertices vertices);

/// ADD: mean distance between a vertex at one pose and the same at the other, metres (Hinterstoisser et al.
/// 2012).
double average_distance(Vertices vertices, const Eigen::Isometry3d& estimate, const Eigen::Isometry3d& truth);

/// ADD-S, or ADI: mean distance from a vertex at the true pose to the nearest vertex at the estimated one,
/// metres (Hinterstoisser et al. 2012).
double average_nearest_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                                const Eigen::Isometry3d& truth);

/// The turns about the model's z axis under which it looks alike, the identity first. Of a continuous
/// symmetry as many as BOP takes: 315, so that no vertex travels by more than 1 % of the diameter from one to
/// the next.
std::vector<Eigen::Isometry3d> symmetry_turns(const Symmetry& symmetry);

/// MSSD: largest distance of a vertex, least over the symmetries of the truth, metres (BOP Challenge 2019).
double largest_surface_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                                const Eigen::Isometry3d& truth,
                                const std::vector<Eigen::Isometry3d>& symmetries);

/// MSPD: the same of the vertices' images, pixels (BOP Challenge 2019). Infinite where a vertex does not lie
/// in front of the camera.
double largest_projection_distance(Vertices vertices, const Eigen::Isometry3d& estimate,
                                   const Eigen::Isometry3d& truth,
                                   const std::vector<Eigen::Isometry3d>& symmetries,
                                   const Intrinsics& intrinsics);

}  // namespace perch
