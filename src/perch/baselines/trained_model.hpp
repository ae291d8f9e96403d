#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "perch/baselines/cloud_descriptors.hpp"
#include "perch/core/stop.hpp"
#include "perch/model/mesh.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// From where a model is looked at to learn its descriptors.
struct TrainingSettings {
  int subdivisions = 3;     ///< of the icosahedron of viewpoints; 3: 642 views (PERCH)
  double distance = 0.8;    ///< of the camera from the object, metres
  double spacing = 0.0015;  ///< of the pixels on the object, metres; a Kinect's at that distance
  DescriptorSettings descriptor;

  /// Throws InvalidSetting naming the field and the value.
  void check() const;
};

/// What was learned of a model: the descriptors of all views in the order of the views; their cloud's frame
/// is the model's.
using TrainedModel = std::vector<CloudDescriptor>;

/// Renders and describes a model from every viewpoint; the same for every executor. Throws Interrupted.
TrainedModel train(const Mesh& mesh, const TrainingSettings& settings, const Executor& executor,
                   const StopCondition& stop);

/// The file of a model's training in a cache: named after a hash of the mesh, the settings, the library and
/// the format.
std::filesystem::path training_file(const std::filesystem::path& cache, const Mesh& mesh,
                                    const TrainingSettings& settings);

/// As train(), from the cache where it holds the model, and kept there otherwise. A damaged file is made
/// anew. \param cache a folder, made where it is missing; empty: no cache. A cache that can't be written to
/// is not used.
TrainedModel trained(const Mesh& mesh, const TrainingSettings& settings, const std::filesystem::path& cache,
                     const Executor& executor, const StopCondition& stop);

}  // namespace perch
