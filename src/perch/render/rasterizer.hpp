#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "perch/core/camera.hpp"
#include "perch/model/mesh.hpp"
#include "perch/render/depth_patch.hpp"

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
  /// A vertex in the camera frame and where it projects, pixels.
  struct Vertex {
    Eigen::Vector3f point;
    float u, v;
  };

  Vertex project(const Eigen::Vector3f& point) const;
  void clip_and_draw(const std::array<Eigen::Vector3f, 3>& corners, const Window& window);
  void draw(const Vertex& a, const Vertex& b, const Vertex& c, const Window& window);

  Intrinsics intrinsics_;
  std::vector<float> ray_x_, ray_y_;  ///< slopes of the pixels' rays; x padded to whole blocks
  std::vector<Vertex> vertices_;
  std::vector<float>
      inverse_depth_;  ///< the window while it is drawn, rows padded to whole blocks; 0 = nothing
  std::size_t pitch_ = 0;
};

}  // namespace perch
