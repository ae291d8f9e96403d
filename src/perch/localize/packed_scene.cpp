#include "perch/localize/packed_scene.hpp"

#include <stdexcept>

namespace perch {
namespace {

void write_transform(ByteWriter& to, const Eigen::Isometry3d& transform) {
  to.raw(transform.data(), 16 * sizeof(double));
}

Eigen::Isometry3d read_transform(ByteReader& from) {
  Eigen::Isometry3d transform;
  std::memcpy(transform.data(), from.raw(16 * sizeof(double)).data(), 16 * sizeof(double));
  return transform;
}

template <typename T>
void write_image(ByteWriter& to, const Image<T>& image) {
  to.value(image.width());
  to.value(image.height());
  to.raw(image.data().data(), image.size() * sizeof(T));
}

template <typename T>
Image<T> read_image(ByteReader& from) {
  const auto width = from.value<int>(), height = from.value<int>();
  const std::size_t size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const auto bytes = from.raw(size * sizeof(T));
  Image<T> image(width, height);
  if (size > 0) std::memcpy(image.row(0), bytes.data(), bytes.size());
  return image;
}

void write_mesh(ByteWriter& to, const Mesh& mesh) {
  to.count(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) to.raw(vertex.data(), 3 * sizeof(float));
  to.values(mesh.triangles);
}

Mesh read_mesh(ByteReader& from) {
  Mesh mesh;
  const std::uint64_t vertices = from.count();
  for (std::uint64_t i = 0; i < vertices; ++i) {
    Eigen::Vector3f vertex;
    std::memcpy(vertex.data(), from.raw(3 * sizeof(float)).data(), 3 * sizeof(float));
    mesh.vertices.push_back(vertex);
  }
  mesh.triangles = from.values<std::array<std::uint32_t, 3>>();
  return mesh;
}

void write_model(ByteWriter& to, const SceneModel& model) {
  to.text(model.name);
  write_mesh(to, model.mesh);
  to.value(model.symmetry);
  to.value(model.base);
  to.value(model.rest_pose);
  write_transform(to, model.stood_from_model);
  to.raw(model.up.data(), 3 * sizeof(double));
}

SceneModel read_model(ByteReader& from) {
  SceneModel model;
  model.name = from.text();
  model.mesh = read_mesh(from);
  from.read(model.symmetry);
  from.read(model.base);
  from.read(model.rest_pose);
  model.stood_from_model = read_transform(from);
  std::memcpy(model.up.data(), from.raw(3 * sizeof(double)).data(), 3 * sizeof(double));
  return model;
}

}  // namespace

void write_scene(ByteWriter& to, const Scene& scene) {
  to.text(scene.name);
  to.value(scene.camera.intrinsics);
  write_transform(to, scene.camera.world_from_camera);
  write_image(to, scene.depth);
  to.value(scene.mask.has_value());
  if (scene.mask) write_image(to, *scene.mask);
  to.value(scene.clutter);
  to.value(scene.table_height);
  to.value(scene.workspace);
  to.count(scene.models.size());
  for (const SceneModel& model : scene.models) write_model(to, model);
  to.count(scene.objects.size());
  for (const SceneObject& object : scene.objects) to.value(object);
}

Scene read_scene(ByteReader& from) {
  Scene scene;
  scene.name = from.text();
  from.read(scene.camera.intrinsics);
  scene.camera.world_from_camera = read_transform(from);
  scene.depth = read_image<float>(from);
  if (from.value<bool>()) scene.mask = read_image<std::uint8_t>(from);
  from.read(scene.clutter);
  from.read(scene.table_height);
  from.read(scene.workspace);
  const std::uint64_t models = from.count();
  for (std::uint64_t i = 0; i < models; ++i) scene.models.push_back(read_model(from));
  const std::uint64_t objects = from.count();
  for (std::uint64_t i = 0; i < objects; ++i) {
    SceneObject object(0);
    from.read(object);
    scene.objects.push_back(object);
  }
  return scene;
}

void write_settings(ByteWriter& to, const Settings& settings) {
  // Every field is a number or an optional one.
  static_assert(std::is_trivially_copyable_v<Settings>);
  to.count(sizeof settings);
  to.value(settings);
}

Settings read_settings(ByteReader& from) {
  if (from.count() != sizeof(Settings))
    throw std::runtime_error("another process has other settings; run the same program on all machines");
  return from.value<Settings>();
}

}  // namespace perch
