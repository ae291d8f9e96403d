#pragma once

#include "perch/io/png.hpp"
#include "perch/io/test_files.hpp"

namespace perch::testing_files {

/// A small scene in block style; tests change single lines of it.
inline const std::string scene_text = R"(version: 1
camera:
  intrinsics: {width: 8, height: 6, fx: 525.0, fy: 526, cx: 3.5, cy: +2.5}
  world_from_camera: [[1, 0, 0, 0.1], [0, -1, 0, 0.2], [0, 0, -1, 0.9], [0, 0, 0, 1]]
observation:
  depth: images/depth.png
  depth_scale: 0.001
  mask: images/mask.png
  color: images/color.png
  background: removed
table: {height: 0.02}
workspace: {x: [-0.2, 0.2], y: [-0.1, 1e-1]}
models:
  mug: {mesh: meshes/box.ply, unit: mm, symmetry: none, base: -0.003}
  can: {mesh: ./meshes/box.ply, unit: mm, symmetry: continuous}
  box: {mesh: meshes/box.obj, symmetry: 2}
objects: [mug, mug, can]
truth:
  - {model: mug, x: 0.10, y: 0.02, yaw: 1.2, symmetry: 4}
  - {model: can, x: -0.10, y: 0, yaw: -1}
)";

/// The files that it names.
inline void write_scene_files(const TemporaryDirectory& dir) {
  Image<std::uint16_t> depth(8, 6);
  for (std::size_t i = 1; i < depth.size(); ++i) depth[i] = static_cast<std::uint16_t>(700 + i);
  dir.write("images/depth.png", encode_png16_gray(depth));
  dir.write("images/mask.png",
            handmade_png(8, 6, 1, 0, {"\xff", "\xff", "\xff", "\x01", "\x80", std::string(1, '\0')}));
  dir.write("images/color.png", encode_png_color(Image<Rgb>(8, 6, {1, 2, 3})));
  dir.write("meshes/box.ply", ply_binary_box(1.0F));
  dir.write("meshes/box.obj", obj_box(0.001F));
}

}  // namespace perch::testing_files
