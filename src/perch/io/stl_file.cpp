#include "perch/io/stl_file.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

#include "perch/io/text_values.hpp"

namespace perch {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

void add_vertex(const Eigen::Vector3d& point, PolygonMesh& mesh) {
  if (!point.cast<float>().allFinite())
    throw FormatFault{fmt::format("has a vertex that is not finite (number {})", mesh.vertices.size())};
  mesh.corners.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
  mesh.vertices.push_back(point);
}

void end_facet(PolygonMesh& mesh) {
  mesh.ends.push_back(mesh.corners.size());
  if (mesh.corners.size() != 3 * mesh.ends.size()) throw FormatFault{"has a facet without three vertices"};
}

std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t k = 4; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[k]);
  return value;
}

PolygonMesh read_binary(std::string_view bytes) {
  if (bytes.size() < header_bytes)
    throw FormatFault{"is truncated or no STL: it has fewer bytes than a header"};
  const std::uint64_t triangles = little_endian(bytes.substr(80));
  const std::uint64_t promised = header_bytes + triangle_bytes * triangles;
  if (promised > bytes.size())
    throw FormatFault{
        fmt::format("is truncated or no STL: its header promises {} triangles, {} bytes; it has {}",
                    triangles, promised, bytes.size())};
  if (promised < bytes.size())
    throw FormatFault{
        fmt::format("has {} bytes more than its {} triangles take", bytes.size() - promised, triangles)};
  PolygonMesh mesh;
  for (std::uint64_t t = 0; t < triangles; ++t) {
    std::string_view numbers = bytes.substr(header_bytes + t * triangle_bytes + 12);  // after the normal
    for (int corner = 0; corner < 3; ++corner) {
      Eigen::Vector3d point;
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = std::bit_cast<float>(little_endian(numbers));
        numbers.remove_prefix(4);
      }
      add_vertex(point, mesh);
    }
    end_facet(mesh);
  }
  return mesh;
}

PolygonMesh read_ascii(std::string_view bytes) {
  PolygonMesh mesh;
  Lines lines(bytes);
  bool ended = false;
  while (const auto whole = lines.next()) {
    std::string_view line = *whole;
    const std::string_view word = next_word(line).value_or("");
    if (word == "vertex") {
      Eigen::Vector3d point;
      for (int axis = 0; axis < 3; ++axis) point[axis] = next_number(line);
      add_vertex(point, mesh);
    } else if (word == "endfacet") {
      end_facet(mesh);
    } else if (word == "endsolid") {
      ended = true;
    } else if (word != "" && word != "solid" && word != "facet" && word != "outer" && word != "endloop") {
      throw FormatFault{fmt::format("has a line with \"{}\"", one_line(word))};
    }
  }
  if (!ended) throw FormatFault{"is truncated: it has no \"endsolid\""};
  if (mesh.corners.size() != 3 * mesh.ends.size()) throw FormatFault{"has a facet without its \"endfacet\""};
  return mesh;
}

}  // namespace

PolygonMesh read_stl(std::string_view bytes) {
  // Binary files may begin with "solid" too, but text holds no NUL.
  const std::size_t begin = std::min(bytes.size(), bytes.find_first_not_of(" \t\r\n"));
  const bool text = bytes.substr(begin).starts_with("solid") && bytes.find('\0') == std::string_view::npos;
  return text ? read_ascii(bytes) : read_binary(bytes);
}

}  // namespace perch
