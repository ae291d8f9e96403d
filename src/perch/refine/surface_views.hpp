#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "perch/core/pose.hpp"
#include "perch/model/object_model.hpp"
#include "perch/refine/surface_samples.hpp"

namespace perch {

/// What a model shows of its surface from every side: evenly spread points of it with normals, rendered once
/// for each bin of directions when it is first asked for. Aligning an object needs no rendering of it then.
/// Safe for several threads; a bin's samples don't depend on who asks first.
class SurfaceViews {
 public:
  /// \param distance of the camera from the object's middle, about, metres. \param samples of a view, about.
  /// Keeps a reference to the model.
  SurfaceViews(const ObjectModel& model, double distance, int samples);

  struct View {
    const SurfaceSamples& samples;  ///< model frame
    double yaw;                     ///< of the object when it looks as the samples do; symmetry made use of
  };
  /// How an object at a pose shows itself to a camera there. \param eye of the camera, world frame, metres.
  View from(const Eigen::Vector3d& eye, const Pose& pose) const;

 private:
  struct Bin {
    std::once_flag made;
    SurfaceSamples samples;
  };
  void make(double azimuth, double elevation, SurfaceSamples& samples) const;

  const ObjectModel& model_;
  double distance_;
  int samples_;
  std::size_t azimuths_, elevations_;
  std::unique_ptr<Bin[]> bins_;
};

}  // namespace perch
