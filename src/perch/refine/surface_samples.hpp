#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace perch {

/// Points of a surface with their unit normals, coordinate by coordinate, so that several can be worked on
/// together.
struct SurfaceSamples {
  std::vector<float> x, y, z;
  std::vector<float> nx, ny, nz;

  std::size_t size() const { return x.size(); }
  bool empty() const { return x.empty(); }
  void clear() { resize(0); }
  void resize(std::size_t size) {
    for (std::vector<float>* values : {&x, &y, &z, &nx, &ny, &nz}) values->resize(size);
  }
  void push_back(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
    x.push_back(point.x());
    y.push_back(point.y());
    z.push_back(point.z());
    nx.push_back(normal.x());
    ny.push_back(normal.y());
    nz.push_back(normal.z());
  }
  Eigen::Vector3f point(std::size_t i) const { return {x[i], y[i], z[i]}; }
  Eigen::Vector3f normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
};

}  // namespace perch
