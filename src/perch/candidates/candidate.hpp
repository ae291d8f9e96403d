#pragma once

#include <cstdint>
#include <vector>

#include "perch/core/pose.hpp"
#include "perch/observation/point_set.hpp"
#include "perch/observation/run.hpp"
#include "perch/render/depth_patch.hpp"

namespace perch {

/// One object at one pose, valued as if it stood alone. Occlusion by others only removes rendered points, so
/// in any scene it explains no point of I outside `explained`.
struct Candidate {
  std::size_t model = 0;  ///< the body
  Pose pose;              ///< after refinement; yaw canonical for the model's symmetry
  bool absent = false;    ///< the object is left out: nothing is rendered, and nothing collides with it

  Window window;                     ///< of its rendering
  PointSet explained;                ///< E(c): points of I within delta of its rendered points
  std::int64_t explained_count = 0;  ///< |E(c)|
  std::int64_t points = 0;           ///< its rendered points (those that count)
  std::int64_t unexplained = 0;      ///< of these, unexplained by I
  std::int64_t exposed = 0;          ///< of those, the ones that no nearer observed point could be hiding

  /// E(c) again, as runs of points: a sum over it costs two look-ups a run.
  std::vector<Run> explained_runs;
  /// B(c): pixels (row-major) that cost one rendered point in every scene with this candidate: unexplained,
  /// and so is every point nearer on the ray, so that whatever hides it is unexplained too.
  std::vector<Run> certain_runs;
  /// U(c): pixels (row-major) of its other unexplained points: each costs one wherever no explained point of
  /// another object hides it.
  std::vector<Run> uncertain_runs;
  /// H(c): pixels (row-major) of its explained points.
  std::vector<Run> explained_pixels;

  PointSet enclosed;  ///< points of I so deep in its solid that nothing beside it can explain them
  PointSet reached;   ///< points of I in its solid dilated by delta

  /// Its rendering; kept only where it explains something, to save memory. See CandidateMaker::patch.
  DepthPatch patch;
  /// It would be kept, but was made in another process: drawing it again is no further work.
  bool drawn_elsewhere = false;
};

/// An optional object that is left out: it explains nothing and costs nothing. \param model the first of its
/// kind.
inline Candidate absent_candidate(std::size_t model) {
  Candidate candidate;
  candidate.model = model;
  candidate.absent = true;
  return candidate;
}

}  // namespace perch
