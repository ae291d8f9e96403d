#include "perch/io/ply_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "perch/io/ply_elements.hpp"

namespace perch {
namespace {

/// The vertices and faces; whatever else a file holds is passed over.
class MeshVisitor final : public PlyVisitor {
 public:
  void header(const PlyHeader& header) override { vertices_ = header.count("vertex"); }

  void list(const PlyElement& element, const PlyProperty& property, std::uint64_t number,
            std::span<const double> values) override {
    if (element.name != "face" || (property.name != "vertex_indices" && property.name != "vertex_index"))
      return;
    for (const double value : values) {
      if (!(value >= 0.0 && value < static_cast<double>(vertices_) && value == std::floor(value)))
        throw FormatFault{
            fmt::format("has a face (number {}) that names vertex {} of {}", number, value, vertices_)};
      mesh.corners.push_back(static_cast<std::uint32_t>(value));
    }
    mesh.ends.push_back(mesh.corners.size());
  }

  void instance(const PlyElement& element, std::uint64_t number, std::span<const double> values) override {
    if (element.name != "vertex") return;
    const Eigen::Vector3d point = ply_point(element, values);
    if (!point.cast<float>().allFinite())
      throw FormatFault{fmt::format("has a vertex that is not finite (number {})", number)};
    mesh.vertices.push_back(point);
  }

  PolygonMesh mesh;

 private:
  std::uint64_t vertices_ = 0;
};

}  // namespace

PolygonMesh read_ply(std::string_view bytes) {
  MeshVisitor visitor;
  read_ply_elements(bytes, visitor);
  return std::move(visitor.mesh);
}

}  // namespace perch
