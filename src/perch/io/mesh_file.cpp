#include "perch/io/mesh_file.hpp"

#include <assimp/scene.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <new>
#include <vector>

#include "perch/core/error.hpp"
#include "perch/io/gltf_check.hpp"
#include "perch/io/message.hpp"
#include "perch/io/obj_file.hpp"
#include "perch/io/ply_file.hpp"
#include "perch/io/polygon_mesh.hpp"
#include "perch/io/read_file.hpp"
#include "perch/io/stl_file.hpp"

namespace perch {
namespace {

constexpr std::uintmax_t largest_file = std::uintmax_t{2} << 30;
constexpr double largest = 5.0;      ///< metres; an object larger than the room has the wrong unit
constexpr double smallest = 0.001;   ///< metres
constexpr double farthest = 1000.0;  ///< metres from the origin; float is no finer than 0.1 mm beyond

/// The file's ending in lower case, without the dot.
std::string format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

/// Appends a part of the importer's scene; throws FormatFault for what the importer let through.
void append(const aiMesh& part, const aiMatrix4x4& root_from_part, PolygonMesh& out) {
  // A file may place one mesh many times.
  constexpr std::size_t most_vertices = 500'000'000;
  const std::size_t first = out.vertices.size();
  if (first + part.mNumVertices > most_vertices) throw FormatFault{"has too many vertices"};
  const aiMatrix4x4& m = root_from_part;
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const double x = part.mVertices[i].x, y = part.mVertices[i].y, z = part.mVertices[i].z;
    const Eigen::Vector3d p(double{m.a1} * x + double{m.a2} * y + double{m.a3} * z + double{m.a4},
                            double{m.b1} * x + double{m.b2} * y + double{m.b3} * z + double{m.b4},
                            double{m.c1} * x + double{m.c2} * y + double{m.c3} * z + double{m.c4});
    if (!p.cast<float>().allFinite())
      throw FormatFault{fmt::format("has a vertex that is not finite (number {})", out.vertices.size())};
    out.vertices.push_back(p);
  }
  for (unsigned f = 0; f < part.mNumFaces; ++f) {
    const aiFace& face = part.mFaces[f];
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= part.mNumVertices)
        throw FormatFault{fmt::format("has a face (number {}) that names vertex {} of {}", f,
                                      face.mIndices[k], part.mNumVertices)};
      out.corners.push_back(static_cast<std::uint32_t>(first + face.mIndices[k]));
    }
    out.ends.push_back(out.corners.size());
  }
}

/// The meshes of all nodes where the nodes place them. Without recursion: files may nest deeper than the
/// stack.
PolygonMesh placed_meshes(const aiScene& scene) {
  PolygonMesh out;
  std::vector<std::pair<const aiNode*, aiMatrix4x4>> open{
      {scene.mRootNode, scene.mRootNode->mTransformation}};
  while (!open.empty()) {
    const auto [node, root_from_node] = open.back();
    open.pop_back();
    for (unsigned m = 0; m < node->mNumMeshes; ++m)
      append(*scene.mMeshes[node->mMeshes[m]], root_from_node, out);
    for (unsigned c = node->mNumChildren; c-- > 0;)
      open.emplace_back(node->mChildren[c], root_from_node * node->mChildren[c]->mTransformation);
  }
  return out;
}

/// Each mesh counted once, however often it is placed.
std::size_t triangles(const aiScene& scene) {
  std::size_t sum = 0;
  for (unsigned m = 0; m < scene.mNumMeshes; ++m)
    for (unsigned f = 0; f < scene.mMeshes[m]->mNumFaces; ++f)
      sum += scene.mMeshes[m]->mFaces[f].mNumIndices == 3;
  return sum;
}

/// Reads a glTF file and what it names. None of the importer's own steps is asked for: they quietly repair
/// what should be refused.
PolygonMesh read_gltf(const std::filesystem::path& path) {
  const std::size_t promised = promised_triangles(path);
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(path.string(), 0);
  if (!scene || !scene->mRootNode)
    throw FormatFault{fmt::format("can't be read as a mesh ({})", one_line(importer.GetErrorString()))};
  const std::size_t read = triangles(*scene);
  if (promised != read)
    throw FormatFault{fmt::format("promises {} triangles, {} of which can be read", promised, read)};
  return placed_meshes(*scene);
}

PolygonMesh read_polygons(const std::filesystem::path& path, const std::string& format) {
  if (format == "glb" || format == "gltf") return read_gltf(path);
  const std::string bytes = read_file(path, largest_file);
  if (format == "ply") return read_ply(bytes);
  return format == "obj" ? read_obj(bytes) : read_stl(bytes);
}

std::string size_fault(const Mesh& mesh, LengthUnit unit, const std::string& unit_key) {
  const Eigen::AlignedBox3d box = mesh.bounds().cast<double>();
  const double across = box.sizes().maxCoeff();
  const auto plausible = [](double metres) { return metres >= smallest && metres <= largest; };
  if (across > largest) {
    if (unit == LengthUnit::metres && plausible(across / 1000))
      return fmt::format("is {:.3g} m across: millimetres taken for metres? set {}: mm", across, unit_key);
    return fmt::format("is {:.3g} m across, larger than {} m; check its lengths and {}", across, largest,
                       unit_key);
  }
  if (across < smallest) {
    if (unit == LengthUnit::millimetres && plausible(across * 1000))
      return fmt::format("is {:.3g} m across: metres taken for millimetres? set {}: m", across, unit_key);
    return fmt::format("is {:.3g} m across, smaller than {} m; check its lengths and {}", across, smallest,
                       unit_key);
  }
  if (box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff() > farthest)
    return fmt::format("lies more than {} m from its origin, too far to be held exactly; move it there",
                       farthest);
  return {};
}

Mesh read_checked(const std::filesystem::path& path, LengthUnit unit, const std::string& unit_key) {
  const auto fail = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", shown(path), what));
  };
  check_file(path, largest_file);
  const std::string format = format_of(path);
  if (format != "ply" && format != "stl" && format != "obj" && format != "glb" && format != "gltf")
    fail(fmt::format("unknown mesh format \"{}\"; give a .ply, .obj, .stl, .glb or .gltf file",
                     one_line(path.extension().string())));
  Mesh mesh;
  try {
    mesh = joined(read_polygons(path, format), unit == LengthUnit::metres ? 1.0 : 0.001);
  } catch (const FormatFault& fault) {
    fail(fault.what + "; export the mesh again");
  }
  if (mesh.triangles.empty()) fail("has no triangles; give a surface, not points or lines");
  const std::string wrong_size = size_fault(mesh, unit, unit_key);
  if (!wrong_size.empty()) fail(wrong_size);
  return mesh;
}

}  // namespace

std::optional<LengthUnit> parse_length_unit(std::string_view word) {
  if (word == "m") return LengthUnit::metres;
  if (word == "mm") return LengthUnit::millimetres;
  return std::nullopt;
}

Mesh read_mesh(const std::filesystem::path& path, LengthUnit unit, const std::string& unit_key) {
  try {
    return read_checked(path, unit, unit_key);
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw InputError(fmt::format("{}: is too large for the memory; simplify the mesh", shown(path)));
  } catch (const std::exception& e) {
    throw InputError(
        fmt::format("{}: can't be read as a mesh ({}); export it again", shown(path), one_line(e.what())));
  }
}

}  // namespace perch
