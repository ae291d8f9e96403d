#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <vector>

#include "perch/localize/scene.hpp"
#include "perch/model/model_symmetries.hpp"

namespace perch {

class JsonEntry;

/// A model of a BOP data set, in metres. Its frame is that of its file, where BOP has +z up when it stands
/// upright and the origin in the middle of its box.
struct BopModel {
  int obj_id = 0;
  ModelSymmetries symmetries;
  /// One for each way in which it may rest. `stood_from_model` starts from the file's frame, so that poses of
  /// the model are poses as BOP has them; what it stands on the plane with is shifted so that the vertical
  /// axis of its symmetry, or else the middle of its box, stands above the origin.
  std::vector<SceneModel> bodies;
};

/// The folder of a data set's models: models_info.json and obj_OBJID.ply, lengths in millimetres.
class BopModels {
 public:
  /// \param upright models stand as in their files; else in every way that rest_poses finds. Reads
  /// models_info.json. Throws InputError.
  BopModels(std::filesystem::path folder, bool upright);
  ~BopModels();

  const std::filesystem::path& folder() const { return folder_; }
  bool contains(int obj_id) const;
  /// The model, whose mesh is read when it is first asked for. Throws InputError where there is none, or
  /// where its mesh and its diameter in models_info.json don't have the same size: one of them is in another
  /// unit.
  const BopModel& get(int obj_id);

 private:
  BopModel read(int obj_id) const;

  std::filesystem::path folder_;
  bool upright_;
  std::unique_ptr<const JsonEntry> info_;
  std::map<int, BopModel> models_;
};

}  // namespace perch
