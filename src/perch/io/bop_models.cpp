#include "perch/io/bop_models.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "perch/core/error.hpp"
#include "perch/core/pose.hpp"
#include "perch/io/bop_json.hpp"
#include "perch/io/mesh_file.hpp"
#include "perch/io/message.hpp"
#include "perch/model/rest_orientation.hpp"
#include "perch/model/rest_poses.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

constexpr double vertical_within = 0.05;  // radians: scanned models don't stand quite even

ModelSymmetries read_symmetries(const JsonEntry& info) {
  constexpr std::size_t most = 1000;
  ModelSymmetries symmetries;
  if (info.contains("symmetries_discrete"))
    for (const JsonEntry& entry : info["symmetries_discrete"].items()) {
      const std::vector<double> numbers = entry.numbers(16);
      Eigen::Matrix4d matrix;
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          matrix(i, j) = numbers[static_cast<std::size_t>(4 * i + j)] * (j == 3 && i < 3 ? 0.001 : 1.0);
      try {
        symmetries.discrete.push_back(rigid_transform(matrix, "the matrix"));
      } catch (const InputError& e) {
        entry.fail(fmt::format("{}; give 4 x 4 numbers, row after row", e.what()));
      }
      if (symmetries.discrete.size() > most)
        entry.fail(fmt::format("is one of more than {}; leave some out", most));
    }
  if (info.contains("symmetries_continuous"))
    for (const JsonEntry& entry : info["symmetries_continuous"].items()) {
      ModelSymmetries::Axis axis;
      const std::vector<double> direction = entry["axis"].numbers(3);
      axis.direction = Eigen::Vector3d(direction[0], direction[1], direction[2]);
      if (!(axis.direction.norm() > 1e-6) || !std::isfinite(axis.direction.norm()))
        entry["axis"].fail("has no direction; give one that is not [0, 0, 0]");
      axis.direction.normalize();
      axis.point = bop_lengths(entry["offset"]);
      symmetries.continuous.push_back(axis);
      if (symmetries.continuous.size() > most)
        entry.fail(fmt::format("is one of more than {}; leave some out", most));
    }
  return symmetries;
}

/// Throws where the mesh is not of the size that the diameter says, both in metres.
void check_diameter(const JsonEntry& entry, const Mesh& mesh, const fs::path& file) {
  constexpr double slack = 1.25;  // data sets state that of other, thinned meshes
  const double given = entry.number(), stated = 0.001 * given;
  const Eigen::Vector3f sides = mesh.bounds().sizes();
  const double least = double{sides.maxCoeff()} / slack, most = slack * double{sides.norm()};
  if (stated >= least && stated <= most) return;
  const char* unit =
      1000.0 * stated >= least && 1000.0 * stated <= most ? "metres taken for millimetres? " : "";
  entry.fail(fmt::format(
      "{} mm is not the diameter of {}, whose box has a diagonal of {:.4g} mm; {}give the largest "
      "distance of two of its vertices in millimetres",
      given, shown(file.filename()), 1000.0 * double{sides.norm()}, unit));
}

/// The model standing with `up` up, above the origin.
SceneModel body_of(const std::string& name, const Mesh& mesh, const ModelSymmetries& symmetries,
                   const Eigen::Vector3d& up, std::size_t index) {
  SceneModel body;
  body.name = name;
  body.rest_pose = static_cast<int>(index);
  body.up = up;
  body.stood_from_model = stood_from_model(mesh, up);
  const ModelSymmetries::Vertical vertical = symmetries.about_up(up, vertical_within);
  body.symmetry = vertical.symmetry;
  Eigen::Vector3d middle = body.stood_from_model * vertical.point;
  if (body.symmetry == Symmetry::none())
    middle = transformed(mesh, body.stood_from_model).bounds().center().cast<double>();
  body.stood_from_model.pretranslate(Eigen::Vector3d(-middle.x(), -middle.y(), 0.0));
  body.mesh = transformed(mesh, body.stood_from_model);
  return body;
}

}  // namespace

BopModels::BopModels(fs::path folder, bool upright)
    : folder_(std::move(folder)),
      upright_(upright),
      info_(std::make_unique<const JsonEntry>(read_bop_json(folder_ / "models_info.json"))) {
  info_->keys();
}

BopModels::~BopModels() = default;

bool BopModels::contains(int obj_id) const {
  return info_->contains(std::to_string(obj_id));
}

const BopModel& BopModels::get(int obj_id) {
  const auto found = models_.find(obj_id);
  if (found != models_.end()) return found->second;
  return models_.emplace(obj_id, read(obj_id)).first->second;
}

BopModel BopModels::read(int obj_id) const {
  if (!contains(obj_id))
    info_->fail(
        fmt::format("has no model {}; name the models of this data set, or give its folder of models with "
                    "--models",
                    obj_id));
  const JsonEntry info = (*info_)[std::to_string(obj_id)];
  BopModel model;
  model.obj_id = obj_id;
  model.symmetries = read_symmetries(info);
  const std::string name = "obj_" + six_digits(obj_id);
  const fs::path file = folder_ / (name + ".ply");
  const Mesh mesh =
      read_mesh(file, LengthUnit::millimetres, "its unit; BOP's models are in millimetres, not");
  check_diameter(info["diameter"], mesh, file);
  std::vector<Eigen::Vector3d> ups{Eigen::Vector3d::UnitZ()};
  if (!upright_) {
    ups.clear();
    try {
      for (const StablePose& pose : rest_poses(mesh, model.symmetries)) ups.push_back(pose.up);
    } catch (const InputError& e) {
      throw InputError(
          fmt::format("{}: {}, so that it rests in no pose; give --upright", shown(file), e.what()));
    }
  }
  for (const Eigen::Vector3d& up : ups)
    model.bodies.push_back(body_of(name, mesh, model.symmetries, up, model.bodies.size()));
  return model;
}

}  // namespace perch
