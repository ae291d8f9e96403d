#pragma once

#include "perch/model/mesh.hpp"

namespace perch::testing_eval {

/// A closed box that stands on z = 0, its axis in the middle; metres.
inline Mesh box(float x, float y, float z) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1) != 0 ? x / 2 : -x / 2, (i & 2) != 0 ? y / 2 : -y / 2,
                               (i & 4) != 0 ? z : 0.0F);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

}  // namespace perch::testing_eval
