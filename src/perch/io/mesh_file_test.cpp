#include "perch/io/mesh_file.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "perch/core/random.hpp"
#include "perch/io/test_files.hpp"

namespace perch {
namespace {

using namespace testing_files;
using ::testing::AllOf;
using ::testing::HasSubstr;

using Maker = std::string (*)(float unit);

std::string ply_big_endian_box(float unit) {
  return ply_binary_box(unit, true);
}
std::string ply_little_endian_box(float unit) {
  return ply_binary_box(unit, false);
}

const std::vector<std::pair<std::string, Maker>> formats{
    {"ascii.ply", ply_ascii_box}, {"little.ply", ply_little_endian_box}, {"big.ply", ply_big_endian_box},
    {"box.obj", obj_box},         {"ascii.stl", stl_ascii_box},          {"binary.STL", stl_binary_box},
    {"box.glb", glb_box}};

/// The volume that a closed surface bounds; negative where it is turned inside out.
double signed_volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto p = [&](int k) { return mesh.vertices[t[static_cast<std::size_t>(k)]].cast<double>().eval(); };
    sum += p(0).dot(p(1).cross(p(2))) / 6;
  }
  return sum;
}

TEST(MeshFile, EveryFormatInBothUnitsIsTheSameBox) {
  const TemporaryDirectory dir;
  for (const auto& [name, make] : formats)
    for (const bool millimetres : {false, true}) {
      SCOPED_TRACE(name + (millimetres ? " in mm" : " in m"));
      const Mesh mesh = read_mesh(dir.write(name, make(millimetres ? 1.0F : 0.001F)),
                                  millimetres ? LengthUnit::millimetres : LengthUnit::metres);
      ASSERT_EQ(mesh.vertices.size(), 8U);
      ASSERT_EQ(mesh.triangles.size(), 12U);
      for (const auto& corner : box_corners) {
        const Eigen::Vector3f p = Eigen::Vector3f(corner[0], corner[1], corner[2]) * 0.001F;
        EXPECT_TRUE(std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                                [&](const auto& v) { return (v - p).norm() < 1e-7F; }));
      }
      EXPECT_TRUE(is_closed(mesh));
      EXPECT_NEAR(signed_volume(mesh), 0.1 * 0.06 * 0.04, 1e-9);
    }
}

TEST(MeshFile, GltfWithItsBufferBesideIt) {
  const TemporaryDirectory dir;
  const std::string glb = glb_box(0.001F);
  const std::size_t data = glb.size() - 168, json_end = glb.rfind('}') + 1;
  const std::size_t last = glb.find("{\"byteLength\":168}");
  ASSERT_LT(last, json_end);
  const std::string json = replaced(glb.substr(20, json_end - 20), "{\"byteLength\":168}",
                                    R"({"byteLength":168,"uri":"box.bin"})");
  dir.write("box.bin", glb.substr(data));
  const Mesh mesh = read_mesh(dir.write("box.gltf", json), LengthUnit::metres);
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_NEAR(signed_volume(mesh), 0.1 * 0.06 * 0.04, 1e-9);
}

TEST(MeshFile, ReadsBinaryBodiesThatBeginLikeALineEnd) {
  const TemporaryDirectory dir;
  for (const char first : {'\n', '\r', ' ', '\t', '\0'}) {
    std::string bytes = ply_binary_box(0.001F);
    const std::size_t body = bytes.find("end_header\n") + 11;
    bytes[body] = first;  // changes the last digits of a coordinate only
    const Mesh mesh = read_mesh(dir.write("box.ply", bytes), LengthUnit::metres);
    EXPECT_NEAR(mesh.bounds().min().x(), -0.05F, 1e-5F);
    EXPECT_EQ(mesh.triangles.size(), 12U);
  }
}

TEST(MeshFile, ReadsWindowsLineEnds) {
  const TemporaryDirectory dir;
  std::string bytes;
  for (const char c : ply_ascii_box(0.001F)) bytes += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(read_mesh(dir.write("box.ply", bytes), LengthUnit::metres).triangles.size(), 12U);
}

TEST(MeshFile, DropsPointsAndLines) {
  const TemporaryDirectory dir;
  const Mesh mesh =
      read_mesh(dir.write("box.obj", obj_box(0.001F) + "v 9 9 9\np 9\nl 1 9\n"), LengthUnit::metres);
  EXPECT_EQ(mesh.vertices.size(), 8U);
  EXPECT_EQ(mesh.triangles.size(), 12U);
}

TEST(MeshFile, ReadsTheOddWaysToWriteObj) {
  const TemporaryDirectory dir;
  const Mesh mesh = read_mesh(dir.write("box.obj",
                                        "f 1/1/1 2//2 3/3 # before its vertices\r\n"
                                        "v 0 0 0 0.5\nv 1 0 0 2 # half\nv 0 1 \\\n 0 1 0 0\n"
                                        "v 0 0 1\nf -4 -1 \\\n-2\nvn 0 0 1\nvt 0 0\n"),
                              LengthUnit::metres);
  EXPECT_EQ(mesh.vertices, (std::vector<Eigen::Vector3f>{{0, 0, 0}, {0.5F, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 3, 2}}));
}

std::string refusal(const std::string& name, const std::string& bytes) {
  const TemporaryDirectory dir;
  const auto path = dir.write(name, bytes);
  const std::string message = input_error([&] { read_mesh(path, LengthUnit::metres, "models.mug.unit"); });
  EXPECT_THAT(message, HasSubstr(name + ": "));
  return message;
}

TEST(MeshFile, RefusesBrokenFilesWithAReason) {
  const std::string ascii = ply_ascii_box(0.001F), binary = ply_binary_box(0.001F);
  EXPECT_THAT(refusal("a.ply", ""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("a.ply", "hello"), HasSubstr("does not begin with \"ply\""));
  EXPECT_THAT(refusal("a.fbx", "hello"), AllOf(HasSubstr("unknown mesh format"), HasSubstr("give a .ply")));
  EXPECT_THAT(refusal("mesh", ascii), HasSubstr("unknown mesh format"));
  EXPECT_THAT(refusal("a.ply", binary.substr(0, binary.find("end_header"))), HasSubstr("header has no end"));
  EXPECT_THAT(refusal("a.ply", binary.substr(0, binary.size() - 1)), HasSubstr("is truncated"));
  EXPECT_THAT(refusal("a.ply", ascii.substr(0, ascii.size() - 10)), HasSubstr("truncated"));
  EXPECT_THAT(refusal("a.ply", replaced(binary, "vertex 8", "vertex 4000000000")), HasSubstr("is truncated"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "vertex 8", "vertex 99999999999999999999")),
              HasSubstr("header"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "4 0 3 2 1", "4 0 3 2 8")),
              HasSubstr("face (number 0) that names vertex 8 of 8"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "4 0 3 2 1", "4 0 3 2 -1")), HasSubstr("names vertex -1"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "4 0 3 2 1", "5 0 3 2 1")), HasSubstr("too few values"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "-0.050000", "nan")),
              HasSubstr("vertex that is not finite (number 0)"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "-0.050000", "1e39")), HasSubstr("not finite"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "-0.050000", "x")), HasSubstr("where a number is expected"));
  EXPECT_THAT(refusal("a.ply", replaced(ascii, "property float z\n", "")), HasSubstr("vertices without z"));
  EXPECT_THAT(refusal("a.ply", replaced(binary, little(-0.05F), little(std::nanf("")))),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal("a.ply", replaced(binary, little(-0.05F), little(INFINITY))), HasSubstr("not finite"));

  const std::string obj = obj_box(0.001F);
  EXPECT_THAT(refusal("a.obj", replaced(obj, "v -0.050000", "v nan")), HasSubstr("not finite"));
  EXPECT_THAT(refusal("a.obj", replaced(obj, "v -0.050000", "v inf")), HasSubstr("not finite"));
  EXPECT_THAT(refusal("a.obj", replaced(obj, "f 1", "f 99")), HasSubstr("names vertex 99 of 8"));
  EXPECT_THAT(refusal("a.obj", replaced(obj, "f 1", "f 0")), HasSubstr("names vertex 0 of 8"));
  EXPECT_THAT(refusal("a.obj", replaced(obj, "f 1", "f -9")), HasSubstr("names vertex -9 of 8"));
  EXPECT_THAT(refusal("a.obj", replaced(obj, "f 1", "f one")), HasSubstr("\"one\""));
  EXPECT_THAT(refusal("a.obj", replaced(obj, " 0.030000\nusemtl", "\nusemtl")), HasSubstr("too few values"));
  EXPECT_THAT(refusal("a.obj", "hello\n"), HasSubstr("no triangles"));

  const std::string stl = stl_binary_box(0.001F), text = stl_ascii_box(0.001F);
  EXPECT_THAT(refusal("a.stl", stl.substr(0, stl.size() - 1)), HasSubstr("promises 12 triangles"));
  EXPECT_THAT(refusal("a.stl", stl + "x"), HasSubstr("more than its 12 triangles"));
  EXPECT_THAT(refusal("a.stl", stl.substr(0, 50)), HasSubstr("truncated"));
  EXPECT_THAT(refusal("a.stl", text.substr(0, text.find("endsolid"))), HasSubstr("truncated"));
  EXPECT_THAT(refusal("a.stl", replaced(text, "vertex -0.050000", "vertex nan")), HasSubstr("not finite"));
  EXPECT_THAT(refusal("a.stl", replaced(stl, little(-0.05F), little(INFINITY))), HasSubstr("not finite"));

  EXPECT_THAT(refusal("a.stl", replaced(text, "vertex", "vertx")), HasSubstr("a line with \"vertx\""));
  EXPECT_THAT(refusal("a.stl", replaced(text, "endfacet\n", "")), HasSubstr("three vertices"));

  const std::string glb = glb_box(0.001F);
  EXPECT_THAT(refusal("a.glb", glb.substr(0, glb.size() / 2)), HasSubstr("truncated"));
  EXPECT_THAT(refusal("a.glb", replaced(glb, "\"count\":8", "\"count\":9")), HasSubstr("a.glb"));
  std::string far = glb;
  far[far.size() - 1] = '\x7f';  // an index beyond the vertices
  EXPECT_THAT(refusal("a.glb", far), HasSubstr("promises 12 triangles, 11 of which"));
  EXPECT_THAT(refusal("a.glb", replaced(glb, little(-30.0F * 0.001F / 2), little(std::nanf("")))),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal("a.glb", replaced(glb, "\"children\":[1]", "\"children\":[0]")), HasSubstr("a.glb"));
}

TEST(MeshFile, RefusesWhatHasNoSurface) {
  const std::string cloud =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "end_header\n0 0 0\n";
  EXPECT_THAT(refusal("cloud.ply", cloud), HasSubstr("has no triangles"));
  EXPECT_THAT(refusal("lines.obj", "v 0 0 0\nv 0 0 1\nl 1 2\n"), HasSubstr("no triangles"));
  std::string none(84, '\0');
  EXPECT_THAT(refusal("none.stl", none), HasSubstr("none.stl"));
}

TEST(MeshFile, SeesTheWrongUnit) {
  const TemporaryDirectory dir;
  const auto millimetres = dir.write("mm.ply", ply_ascii_box(1.0F));
  EXPECT_THAT(input_error([&] { read_mesh(millimetres, LengthUnit::metres, "models.mug.unit"); }),
              HasSubstr("mm.ply: is 100 m across: millimetres taken for metres? set models.mug.unit: mm"));
  const auto metres = dir.write("m.ply", ply_ascii_box(0.001F));
  EXPECT_THAT(input_error([&] { read_mesh(metres, LengthUnit::millimetres, "models.mug.unit"); }),
              HasSubstr("m.ply: is 0.0001 m across: metres taken for millimetres? set models.mug.unit: m"));
  const auto neither = dir.write("huge.ply", ply_ascii_box(1000.0F));
  EXPECT_THAT(input_error([&] { read_mesh(neither, LengthUnit::metres); }), HasSubstr("larger than 5 m"));
}

TEST(MeshFile, RefusesMissingFilesAndDirectories) {
  const TemporaryDirectory dir;
  EXPECT_THAT(input_error([&] { read_mesh(dir.path() / "none.ply", LengthUnit::metres); }),
              HasSubstr("none.ply: no such file"));
  std::filesystem::create_directory(dir.path() / "dir.ply");
  EXPECT_THAT(input_error([&] { read_mesh(dir.path() / "dir.ply", LengthUnit::metres); }),
              HasSubstr("directory"));
  const auto odd = dir.write("two\nlines.ply", "x");
  EXPECT_THAT(input_error([&] { read_mesh(odd, LengthUnit::metres); }), HasSubstr("two\\nlines.ply"));
}

TEST(MeshFile, DamagedFilesLoadOrAreRefusedAndNothingElse) {
  const TemporaryDirectory dir;
  testing::internal::CaptureStderr();
  for (const auto& [name, make] : formats) {
    const std::string whole = make(0.001F);
    for (std::uint64_t seed = 0; seed < 400; ++seed) {
      SCOPED_TRACE(name + ", seed " + std::to_string(seed));
      Random random(seed);
      std::string bytes = whole;
      if (seed % 2 == 0) bytes.resize(random.below(bytes.size()));
      for (std::uint64_t k = seed % 2 == 0 ? 0 : 1 + random.below(4); k > 0; --k)
        bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
      try {
        EXPECT_EQ(mesh_fault(read_mesh(dir.write(name, bytes), LengthUnit::metres)), "");
      } catch (const InputError& e) {
        EXPECT_THAT(e.what(), HasSubstr(name + ": "));
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      }
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace perch
