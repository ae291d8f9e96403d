#include "perch/baselines/trained_model.hpp"

#include <fmt/format.h>

#include <iterator>

#include "perch/baselines/descriptor_file.hpp"
#include "perch/baselines/icosphere.hpp"
#include "perch/baselines/object_view.hpp"
#include "perch/core/error.hpp"

namespace perch {
namespace {

std::uint64_t training_key(const Mesh& mesh, const TrainingSettings& settings) {
  Fingerprint print;
  const std::string library = descriptor_library();
  print.add(std::as_bytes(std::span(library)));
  print.add_value(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    for (const float coordinate : vertex) print.add_value(coordinate);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle) print.add_value(corner);
  print.add_value(settings.subdivisions);
  print.add_value(settings.distance);
  print.add_value(settings.spacing);
  const DescriptorSettings& d = settings.descriptor;
  for (const double value :
       {d.voxel, d.smoothing_radius, d.upsampling_radius, d.upsampling_step, d.normal_radius,
        d.largest_curvature, d.largest_bend, d.region_spread, d.region_gap})
    print.add_value(value);
  print.add_value(d.least_region);
  print.add_value(d.normalized);
  return print.value();
}

}  // namespace

void TrainingSettings::check() const {
  const auto in_range = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InvalidSetting(
          fmt::format("ourcvfh.{} is {}; it must lie between {} and {}", field, value, low, high));
  };
  in_range("subdivisions", subdivisions, 0, 5);
  in_range("distance", distance, 0.05, 10.0);
  in_range("spacing", spacing, 1e-4, 0.1);
  descriptor.check();
}

TrainedModel train(const Mesh& mesh, const TrainingSettings& settings, const Executor& executor,
                   const StopCondition& stop) {
  const Icosphere sphere = icosphere(settings.subdivisions);
  std::vector<std::vector<CloudDescriptor>> views(sphere.vertices.size());
  const auto describe = [&](std::size_t i, std::size_t) {
    const ObjectView view = view_object(mesh, sphere.vertices[i], settings.distance, settings.spacing);
    const Eigen::Vector3d up = view.camera_from_model.linear() * Eigen::Vector3d::UnitZ();
    views[i] = describe_cloud(view.points, up, settings.descriptor);
    for (CloudDescriptor& descriptor : views[i])
      descriptor.frame_from_cloud = descriptor.frame_from_cloud * view.camera_from_model;
  };
  if (!executor.for_each(views.size(), describe, stop)) throw Interrupted();
  TrainedModel trained;
  for (std::vector<CloudDescriptor>& view : views)
    trained.insert(trained.end(), std::make_move_iterator(view.begin()), std::make_move_iterator(view.end()));
  return trained;
}

std::filesystem::path training_file(const std::filesystem::path& cache, const Mesh& mesh,
                                    const TrainingSettings& settings) {
  return cache / fmt::format("ourcvfh_{:016x}.bin", training_key(mesh, settings));
}

TrainedModel trained(const Mesh& mesh, const TrainingSettings& settings, const std::filesystem::path& cache,
                     const Executor& executor, const StopCondition& stop) {
  if (cache.empty()) return train(mesh, settings, executor, stop);
  const std::uint64_t key = training_key(mesh, settings);
  const std::filesystem::path file = training_file(cache, mesh, settings);
  if (auto kept = read_descriptors(file, key)) return *std::move(kept);
  TrainedModel model = train(mesh, settings, executor, stop);
  write_descriptors(file, key, model);
  return model;
}

}  // namespace perch
