#include "perch/io/gltf_check.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "perch/io/message.hpp"
#include "perch/io/polygon_mesh.hpp"
#include "perch/io/read_file.hpp"

namespace perch {
namespace {

using Json = nlohmann::json;

/// The JSON of the file: all of a .gltf; of a .glb the first chunk, after a header of 12 bytes and its own of
/// 8.
std::string_view json_part(std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return bytes;
  if (bytes.size() < 20) throw FormatFault{"is truncated: it has fewer bytes than a header"};
  std::size_t length = 0;
  for (std::size_t k = 4; k-- > 0;) length = length << 8 | static_cast<unsigned char>(bytes[12 + k]);
  if (length > bytes.size() - 20)
    throw FormatFault{"is truncated: its header promises more than the file holds"};
  return bytes.substr(20, length);
}

/// The triangles of `n` corners in a primitive's mode; 0 for points and lines.
std::size_t triangles_of(int mode, std::size_t n) {
  constexpr int list = 4, strip = 5, fan = 6;
  if (mode == list) return n / 3;
  return (mode == strip || mode == fan) && n >= 3 ? n - 2 : 0;
}

}  // namespace

std::size_t promised_triangles(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, std::uintmax_t{2} << 30);
  std::size_t sum = 0;
  try {
    const Json gltf = Json::parse(json_part(bytes));
    for (const Json& mesh : gltf.at("meshes"))
      for (const Json& primitive : mesh.at("primitives")) {
        const Json& attributes = primitive.at("attributes");
        const Json& corners =
            primitive.contains("indices") ? primitive.at("indices") : attributes.at("POSITION");
        const auto n = gltf.at("accessors").at(corners.get<std::size_t>()).at("count").get<std::size_t>();
        sum += triangles_of(primitive.value("mode", 4), n);
      }
  } catch (const Json::exception& e) {
    throw FormatFault{fmt::format("is no complete glTF 2 file ({})", one_line(e.what()))};
  }
  return sum;
}

}  // namespace perch
