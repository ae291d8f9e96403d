#include "perch/io/obj_file.hpp"

#include <cmath>

#include "perch/io/text_values.hpp"

namespace perch {
namespace {

/// `v x y z`, then nothing, a weight, or a colour.
Eigen::Vector3d vertex(std::string_view line, std::size_t number) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) point[axis] = next_number(line);
  std::string_view rest = line;
  std::size_t more = 0;
  while (next_word(rest)) ++more;
  if (more == 1) point /= next_number(line);
  if (!point.cast<float>().allFinite())
    throw FormatFault{fmt::format("has a vertex that is not finite (number {})", number)};
  return point;
}

/// The vertex that a corner `v`, `v/vt`, `v//vn` or `v/vt/vn` of a face names: counted from 1, or back from
/// the last one so far where negative.
std::uint32_t corner(std::string_view word, std::size_t vertices_so_far) {
  const std::string_view text = word.substr(0, word.find('/'));
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size())
    throw FormatFault{
        fmt::format("has a face with \"{}\" where a vertex's number is expected", one_line(word))};
  const std::int64_t index = number < 0 ? static_cast<std::int64_t>(vertices_so_far) + number : number - 1;
  if (index < 0 || index > std::numeric_limits<std::uint32_t>::max())
    throw FormatFault{fmt::format("has a face that names vertex {} of {}", number, vertices_so_far)};
  return static_cast<std::uint32_t>(index);
}

}  // namespace

PolygonMesh read_obj(std::string_view bytes) {
  PolygonMesh mesh;
  Lines lines(bytes);
  std::string joined_line;
  while (const auto whole = lines.next()) {
    std::string_view line = *whole;
    if (line.ends_with('\\')) {  // goes on in the next line
      joined_line.clear();
      std::optional<std::string_view> part = line;
      for (; part && part->ends_with('\\'); part = lines.next())
        joined_line.append(part->substr(0, part->size() - 1)).append(1, ' ');
      if (part) joined_line.append(*part);
      line = joined_line;
    }
    line = line.substr(0, line.find('#'));
    const auto keyword = next_word(line);
    if (keyword == "v") {
      mesh.vertices.push_back(vertex(line, mesh.vertices.size() + 1));
    } else if (keyword == "f") {
      while (const auto word = next_word(line)) mesh.corners.push_back(corner(*word, mesh.vertices.size()));
      mesh.ends.push_back(mesh.corners.size());
    }
  }
  // A face may stand before its vertices.
  for (const std::uint32_t index : mesh.corners)
    if (index >= mesh.vertices.size())
      throw FormatFault{fmt::format("has a face that names vertex {} of {}", std::uint64_t{index} + 1,
                                    mesh.vertices.size())};
  return mesh;
}

}  // namespace perch
