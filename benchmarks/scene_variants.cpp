#include "scene_variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <queue>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "perch/core/error.hpp"

namespace perch {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller number first

/// A mesh whose equal vertices are one, so that triangles know their neighbours across seams.
Mesh merged_at_seams(const Mesh& mesh) {
  Mesh merged;
  std::map<std::tuple<float, float, float>, std::uint32_t> numbers;
  std::vector<std::uint32_t> number_of;
  for (const Eigen::Vector3f& p : mesh.vertices) {
    const auto [entry, added] =
        numbers.try_emplace({p.x(), p.y(), p.z()}, static_cast<std::uint32_t>(numbers.size()));
    if (added) merged.vertices.push_back(p);
    number_of.push_back(entry->second);
  }
  for (const auto& [a, b, c] : mesh.triangles)
    merged.triangles.push_back({number_of[a], number_of[b], number_of[c]});
  return merged;
}

/// Halves edges, the longest first.
class EdgeSplitter {
 public:
  explicit EdgeSplitter(Mesh mesh) : mesh_(std::move(mesh)) {
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) add_edges(t);
  }

  void split_longest() {
    const Edge edge = longest_.top().second;
    longest_.pop();
    const auto found = triangles_at_.find(edge);
    if (found == triangles_at_.end()) return;  // entered twice
    const std::vector<std::uint32_t> around = std::move(found->second);
    triangles_at_.erase(found);
    const auto middle = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.push_back(0.5F * (mesh_.vertices[edge.first] + mesh_.vertices[edge.second]));
    for (const std::uint32_t t : around) split(t, edge, middle);
  }
  const Mesh& mesh() const { return mesh_; }

 private:
  static Edge between(std::uint32_t a, std::uint32_t b) { return std::minmax({a, b}); }

  void add_edges(std::uint32_t t) {
    const auto& corners = mesh_.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge = between(corners[i], corners[(i + 1) % 3]);
      auto& around = triangles_at_[edge];
      if (around.empty())
        longest_.emplace((mesh_.vertices[edge.first] - mesh_.vertices[edge.second]).squaredNorm(), edge);
      around.push_back(t);
    }
  }

  void split(std::uint32_t t, const Edge& edge, std::uint32_t middle) {
    const auto corners = mesh_.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge side = between(corners[i], corners[(i + 1) % 3]);
      if (side != edge) std::erase(triangles_at_[side], t);
    }
    auto half = corners, other_half = corners;
    std::replace(half.begin(), half.end(), edge.first, middle);
    std::replace(other_half.begin(), other_half.end(), edge.second, middle);
    mesh_.triangles[t] = half;
    mesh_.triangles.push_back(other_half);
    add_edges(t);
    add_edges(static_cast<std::uint32_t>(mesh_.triangles.size() - 1));
  }

  Mesh mesh_;
  std::map<Edge, std::vector<std::uint32_t>> triangles_at_;
  std::priority_queue<std::pair<float, Edge>> longest_;
};

}  // namespace

Mesh with_triangles(const Mesh& mesh, std::size_t triangles) {
  EdgeSplitter splitter(merged_at_seams(mesh));
  while (splitter.mesh().triangles.size() < triangles) splitter.split_longest();
  return splitter.mesh();
}

Scene padded(Scene scene, int width, int height) {
  const Intrinsics old = scene.camera.intrinsics;
  if (width < old.width || height < old.height)
    throw InvalidSetting(fmt::format("the image would have {} x {} pixels; it can't be smaller than {} x {}",
                                     width, height, old.width, old.height));
  const int left = (width - old.width) / 2, top = (height - old.height) / 2;
  const auto pad = [&](const auto& image) {
    auto larger = std::decay_t<decltype(image)>(width, height);
    for (int v = 0; v < old.height; ++v) std::copy_n(image.row(v), old.width, larger.row(v + top) + left);
    return larger;
  };
  scene.depth = pad(scene.depth);
  if (scene.mask) scene.mask = pad(*scene.mask);
  scene.color.reset();  // for pictures only
  scene.camera.intrinsics = {width, height, old.fx, old.fy, old.cx + left, old.cy + top};
  return scene;
}

}  // namespace perch
