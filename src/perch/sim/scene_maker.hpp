#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/sim/ground_plan.hpp"
#include "perch/sim/scene_recipe.hpp"
#include "perch/sim/simulated_scene.hpp"

namespace perch {

/// A scene and what is known about it beyond its file.
struct MadeScene {
  SimulatedScene simulated;
  std::uint64_t seed = 0;
  std::vector<std::int64_t> visible;  ///< pixels at which each object is the nearest
  std::vector<std::int64_t> alone;    ///< pixels that each would cover alone
  Image<std::uint8_t> objects;        ///< at each pixel 1 + the object that its ray meets first, 0 for none
};

/// Makes scenes after a recipe. The models' meshes and footprints are made once; after that it is constant,
/// and threads may share it.
class SceneMaker {
 public:
  /// Throws what SceneRecipe::check throws.
  explicit SceneMaker(const SceneRecipe& recipe);

  const SceneRecipe& recipe() const { return recipe_; }
  /// All models that scenes may hold.
  const std::vector<SceneModel>& models() const { return models_; }

  /// The scene of a seed: objects on the table z = 0, wholly in view, visible as the recipe asks, the same
  /// for the same seed. The sensor sees objects and table together; where the recipe doesn't ask for the
  /// table, readings that come from it are removed after that. Throws InvalidSetting where no such scene was
  /// found in 3,000 tries, saying what was in the way.
  MadeScene make(std::uint64_t seed) const;

 private:
  std::vector<std::size_t> draw_models(Random& random) const;
  std::vector<std::size_t> draw_chess_pieces(Random& random) const;
  Camera draw_camera(Random& random) const;
  bool place_anywhere(Random& random, const std::vector<std::size_t>& drawn,
                      std::vector<PlacedModel>& placed) const;
  bool place_on_squares(Random& random, const std::vector<std::size_t>& drawn,
                        std::vector<PlacedModel>& placed) const;
  bool is_free(const PlacedModel& candidate, const std::vector<PlacedModel>& placed) const;
  MadeScene sensed(const SceneLayout& layout, const RenderedLayout& rendered, std::uint64_t noise_seed) const;

  SceneRecipe recipe_;
  std::vector<SceneModel> models_;
  std::vector<GroundPlan> plans_;  ///< of the models
};

}  // namespace perch
