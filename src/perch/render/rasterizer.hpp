#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/model/mesh.hpp"
#include "perch/render/depth_patch.hpp"
#include "perch/render/pixel_cells.hpp"
#include "perch/render/projection.hpp"
#include "perch/render/triangle_drawing.hpp"

namespace perch {

/// Renders the depth of one mesh at one pose. Samples exactly at pixel centres, interpolates 1/z
/// (perspective-correct), clips at the near plane, draws both faces of every triangle, and leaves no cracks
/// between triangles that share an edge. Holds scratch memory: one rasterizer a thread.
class Rasterizer {
 public:
  /// What lies nearer to the camera's plane than this is cut off, metres.
  static constexpr float near_plane = 0.01F;

  explicit Rasterizer(const Intrinsics& intrinsics);

  /// Renders into `patch`, whose memory is reused. The patch's window is the image of the mesh's bounds, cut
  /// to the image; empty where nothing is in view.
  void render(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model, DepthPatch& patch);
  DepthPatch render(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model);

  const Intrinsics& intrinsics() const { return intrinsics_; }

 private:
  /// Projects the mesh. Returns its window in the image; empty where nothing is in view.
  Window project_mesh(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model);
  void draw(const Window& window, DepthPatch& patch);
  /// Replaces the triangles that reach in front of the near plane by what is left of them.
  void clip(const Mesh& mesh);

  Intrinsics intrinsics_;
  std::vector<float> ray_x_, ray_y_;  ///< slopes of the pixels' rays
  std::vector<ProjectedVertex> vertices_;
  std::vector<Triangle> clipped_;
  const std::vector<Triangle>* triangles_ = nullptr;  ///< of the mesh, or clipped_
  PixelCells cells_;                                  ///< the window while it is drawn
};

}  // namespace perch
