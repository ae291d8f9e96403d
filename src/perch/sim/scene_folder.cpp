#include "perch/sim/scene_folder.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <sstream>

#include "perch/io/atomic_write.hpp"
#include "perch/io/png.hpp"
#include "perch/model/rest_orientation.hpp"

namespace perch {
namespace {

void append_little_endian(std::string& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>((value >> shift) & 0xFFU));
}

std::string commented(const std::string& comment) {
  std::string text, line;
  std::istringstream lines(comment);
  while (std::getline(lines, line)) text += "# " + line + "\n";
  return text;
}

/// The directions that may point up, where that is not z alone. \param first body of a model.
std::string rest_poses_key(const std::vector<SceneModel>& models, std::size_t first) {
  const std::size_t poses = rest_pose_count(models, first);
  if (poses == 1 && models[first].up == Eigen::Vector3d::UnitZ()) return "";
  std::string list;
  for (std::size_t m = first; m < first + poses; ++m)
    list += fmt::format("{}[{}, {}, {}]", list.empty() ? "" : ", ", exact_number(models[m].up.x()),
                        exact_number(models[m].up.y()), exact_number(models[m].up.z()));
  return ", rest_poses: [" + list + "]";
}

}  // namespace

std::string encode_ply(const Mesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      mesh.vertices.size(), mesh.triangles.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    for (const float coordinate : vertex)
      append_little_endian(bytes, std::bit_cast<std::uint32_t>(coordinate));
  for (const auto& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const std::uint32_t vertex : triangle) append_little_endian(bytes, vertex);
  }
  return bytes;
}

std::string exact_number(double value) {
  return fmt::format("{}", value + 0.0);
}

std::string scene_yaml(const SimulatedScene& simulated, const std::string& comment,
                       const std::string& model_folder) {
  const Scene& scene = simulated.scene;
  const Intrinsics& k = scene.camera.intrinsics;
  std::string text = commented(comment) + "version: 1\ncamera:\n";
  text +=
      fmt::format("  intrinsics: {{width: {}, height: {}, fx: {}, fy: {}, cx: {}, cy: {}}}\n", k.width,
                  k.height, exact_number(k.fx), exact_number(k.fy), exact_number(k.cx), exact_number(k.cy));
  text += "  world_from_camera:  # metres; camera x right, y down, z forward; world z up\n";
  const Eigen::Matrix4d pose = scene.camera.world_from_camera.matrix();
  for (int i = 0; i < 4; ++i)
    text += fmt::format("    - [{}, {}, {}, {}]\n", exact_number(pose(i, 0)), exact_number(pose(i, 1)),
                        exact_number(pose(i, 2)), exact_number(pose(i, 3)));
  text +=
      fmt::format("observation:\n  depth: depth.png\n  depth_scale: {}  # metres per count; 0 = no reading\n",
                  exact_number(scene.depth_scale));
  if (scene.mask)
    text += "  mask: mask.png  # non-zero: the reading is one of an object\n  background: removed\n";
  else
    text += "  background: removed  # every pixel with a reading belongs to an object\n";
  if (scene.table_height)
    text += fmt::format("table: {{height: {}}}  # world z of the support plane, metres\n",
                        exact_number(*scene.table_height));
  if (const auto& w = scene.workspace)
    text += fmt::format("workspace: {{x: [{}, {}], y: [{}, {}]}}  # where object origins may lie, metres\n",
                        exact_number(w->x_min), exact_number(w->x_max), exact_number(w->y_min),
                        exact_number(w->y_max));
  text += "models:\n";
  for (std::size_t m = 0; m < scene.models.size(); ++m) {
    if (scene.kind(m) != m) continue;
    const SceneModel& model = scene.models[m];
    text += fmt::format("  {0}: {{mesh: {1}/{0}.ply, unit: m, symmetry: {2}, base: {3}{4}}}\n", model.name,
                        model_folder, model.symmetry.name(), exact_number(model.base),
                        rest_poses_key(scene.models, m));
  }
  text += "objects: [";
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    text += fmt::format(fmt::runtime(scene.objects[i].optional ? "{}{{model: {}, optional: true}}" : "{}{}"),
                        i == 0 ? "" : ", ", scene.models[scene.objects[i].model].name);
  text += "]\n";
  const auto placed_at = [&](std::size_t model, const Pose& at) {
    const std::string rest = rest_pose_count(scene.models, model) > 1
                                 ? fmt::format(", rest_pose: {}", scene.models[model].rest_pose)
                                 : "";
    return fmt::format("  - {{model: {}, x: {}, y: {}, yaw: {}{}}}", scene.models[model].name,
                       exact_number(at.x), exact_number(at.y), exact_number(at.yaw), rest);
  };
  if (!scene.priors.empty()) text += "priors:  # from another detector; metres and radians\n";
  for (const PlacedModel& prior : scene.priors) text += placed_at(prior.model, prior.pose) + "\n";
  text += "truth:  # metres and radians\n";
  for (std::size_t i = 0; i < scene.truth.size(); ++i)
    text += placed_at(scene.truth[i].model, scene.truth[i].pose) +
            fmt::format("  # {:.0f} % visible\n", 100.0 * simulated.visible_fractions[i]);
  return text;
}

void write_scene_folder(const std::filesystem::path& folder, const SimulatedScene& simulated,
                        const std::string& comment) {
  const Scene& scene = simulated.scene;
  OutputSet models, top;
  for (const SceneModel& model : scene.models)
    if (model.rest_pose == 0)
      models.add(model.name + ".ply", encode_ply(transformed(model.mesh, model.stood_from_model.inverse())));
  top.add("depth.png", encode_png16_gray(counts_from_depth(scene.depth, scene.depth_scale)));
  top.add("scene.yaml", scene_yaml(simulated, comment));
  models.commit(folder / "models");
  top.commit(folder);
}

}  // namespace perch
