#include "perch/model/convex_hull.hpp"

#include <libqhull_r/libqhull_r.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <stdexcept>

#include "perch/core/error.hpp"

namespace perch {
namespace {

/// Qhull's state, and the file that its messages go to: they have many lines and speak of options of its own.
class Hull {
 public:
  /// \param points x, y, z of each; must live as long as this. Throws InputError for flat ones.
  explicit Hull(std::vector<double>& points) : silence_(std::fopen("/dev/null", "w"), std::fclose) {
    if (!silence_) throw std::runtime_error("/dev/null can't be opened");
    qh_zero(&state_, silence_.get());
    // Qt: facets of more than three vertices are cut into triangles; Pp: no warnings.
    char options[] = "qhull Qt Pp";
    const int failed = qh_new_qhull(&state_, 3, static_cast<int>(points.size() / 3), points.data(), False,
                                    options, nullptr, silence_.get());
    if (failed == 0) return;
    release();
    if (failed == qh_ERRmem) throw std::bad_alloc();
    throw InputError("is flat or nearly so");
  }
  ~Hull() { release(); }
  Hull(const Hull&) = delete;
  Hull& operator=(const Hull&) = delete;

  qhT* state() { return &state_; }

 private:
  void release() {
    int bytes = 0, pieces = 0;
    qh_freeqhull(&state_, !qh_ALL);
    qh_memfreeshort(&state_, &bytes, &pieces);
  }

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence_;
  qhT state_{};
};

/// Triangles over the vertices of the mesh.
std::vector<std::array<std::uint32_t, 3>> hull_triangles(const Mesh& mesh) {
  std::vector<double> points;
  points.reserve(3 * mesh.vertices.size());
  for (const Eigen::Vector3f& p : mesh.vertices)
    for (const float x : p) points.push_back(double{x});
  Hull hull(points);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const facetT* facet = hull.state()->facet_list; facet && facet->next; facet = facet->next) {
    std::array<std::uint32_t, 3> t{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto* vertex = static_cast<const vertexT*>(facet->vertices->e[i].p);
      t[i] = static_cast<std::uint32_t>(qh_pointid(hull.state(), vertex->point));
    }
    // The vertices' order says which way it faces only together with a flag.
    if ((facet->toporient ^ qh_ORIENTclock) != 0) std::swap(t[0], t[1]);
    triangles.push_back(t);
  }
  return triangles;
}

}  // namespace

Mesh convex_hull(const Mesh& mesh) {
  if (mesh.vertices.size() < 4) throw InputError("has fewer than four vertices");
  Mesh hull;
  hull.triangles = hull_triangles(mesh);
  std::vector<std::uint32_t> number(mesh.vertices.size(), 0);  // in the hull, + 1; 0: not in it yet
  for (auto& triangle : hull.triangles)
    for (std::uint32_t& vertex : triangle) {
      if (number[vertex] == 0) {
        hull.vertices.push_back(mesh.vertices[vertex]);
        number[vertex] = static_cast<std::uint32_t>(hull.vertices.size());
      }
      vertex = number[vertex] - 1;
    }
  return hull;
}

VolumeCentroid volume_centroid(const Mesh& mesh) {
  // About a point of the mesh: far from the origin the tetrahedra's volumes would cancel each other.
  const Eigen::Vector3d origin =
      mesh.vertices.empty() ? Eigen::Vector3d::Zero().eval() : mesh.vertices[0].cast<double>().eval();
  VolumeCentroid sum;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[i].cast<double>() - origin,
                          b = mesh.vertices[j].cast<double>() - origin,
                          c = mesh.vertices[k].cast<double>() - origin;
    const double volume = a.dot(b.cross(c)) / 6.0;  // of the tetrahedron with the origin
    sum.volume += volume;
    sum.centroid += volume / 4.0 * (a + b + c);
  }
  if (sum.volume != 0.0) sum.centroid /= sum.volume;
  sum.centroid += origin;
  return sum;
}

double hull_diameter(const Mesh& hull) {
  double most = 0.0;
  for (std::size_t i = 0; i < hull.vertices.size(); ++i)
    for (std::size_t j = i + 1; j < hull.vertices.size(); ++j)
      most = std::max(most, (hull.vertices[i] - hull.vertices[j]).cast<double>().squaredNorm());
  return std::sqrt(most);
}

}  // namespace perch
