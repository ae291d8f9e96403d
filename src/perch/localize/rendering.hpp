#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "perch/core/image.hpp"
#include "perch/localize/result.hpp"
#include "perch/localize/scene.hpp"
#include "perch/localize/settings.hpp"
#include "perch/parallel/executor.hpp"

namespace perch {

/// A scene drawn pixel by pixel, and where it and the depth image leave each other unexplained. Every image
/// has the size of the scene's depth image.
struct SceneRendering {
  /// What `object` holds where no object is seen.
  static constexpr std::uint32_t no_object = std::numeric_limits<std::uint32_t>::max();

  DepthImage depth;              ///< nearest surface, metres along the optical axis; 0 = nothing rendered
  Image<std::uint32_t> object;   ///< whose surface that is, counting into the placed objects, or no_object
  Image<std::uint8_t> observed;  ///< 1: the pixel holds a point of I
  Image<std::uint8_t> observed_unexplained;  ///< 1: it does, and no rendered point lies within delta of it
  Image<std::uint8_t> rendered_unexplained;  ///< 1: its rendered point has no point of I within delta
  Image<std::uint8_t> left_out;  ///< 1: its rendered point doesn't count, since the setting for missing depth
                                 ///< ignores it
  CostRecord
      cost;  ///< the numbers of flagged pixels: J_observed, J_rendered and their sum, as `score` counts

  /// The object seen at a pixel; empty where none is.
  std::optional<std::size_t> object_at(int u, int v) const {
    const std::uint32_t i = object(u, v);
    return i == no_object ? std::nullopt : std::optional<std::size_t>(i);
  }
};

/// Renders placed objects at full resolution; of two at the same depth the first is seen. \param placed any
/// number of objects, none included. Throws InputError where nothing was observed, InvalidSetting for a bad
/// setting.
SceneRendering render_scene(const Scene& scene, const std::vector<PlacedModel>& placed,
                            const Settings& settings, const Executor& executor);

/// The objects of a result as poses of the scene's models, in the result's order. Throws std::logic_error
/// where the result names a model or a rest pose that the scene doesn't have.
std::vector<PlacedModel> placed_objects(const Scene& scene, const Result& result);

}  // namespace perch
