#include <numbers>

#include "perch/io/cloud_depth_file.hpp"
#include "perch/io/cloud_file.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/io/test_clouds.hpp"
#include "perch/io/test_scene.hpp"

namespace perch {
namespace {

using namespace testing_files;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const double no_number = std::nan("");
const Eigen::Vector3d not_a_point(no_number, no_number, no_number);

/// A surface that slopes and has holes: as a camera sees it, in float.
DepthImage random_depth(Random& random, const Intrinsics& k) {
  DepthImage depth(k.width, k.height);
  const double slope = random.uniform(-0.01, 0.01), base = random.uniform(0.5, 1.5);
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u)
      if (random.below(5)) depth(u, v) = static_cast<float>(base + slope * u + random.uniform(0.0, 0.1));
  depth(0, 0) = static_cast<float>(base);
  return depth;
}

Intrinsics random_intrinsics(Random& random) {
  const int width = 6 + static_cast<int>(random.below(20)), height = 5 + static_cast<int>(random.below(20));
  return {width,
          height,
          random.uniform(20, 60),
          random.uniform(20, 60),
          width * random.uniform(0.3, 0.7),
          height * random.uniform(0.3, 0.7)};
}

Eigen::Isometry3d random_pose(Random& random) {
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  Eigen::Isometry3d pose(turn.normalized());
  pose.translation() << random.normal(), random.normal(), random.normal();
  return pose;
}

std::string viewpoint_line(const Eigen::Isometry3d& pose) {
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return fmt::format("VIEWPOINT {} {} {} {} {} {} {}\n", t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
}

class Clouds : public ::testing::Test {
 protected:
  DepthImage depth_of(const CloudWriter& writer, const Points& points, std::size_t width, std::size_t height,
                      const Camera& camera, const CloudReading& reading = {}) {
    return read_cloud_depth(
        dir.write(std::string("cloud") + writer.ending(), writer.write(points, width, height)), reading,
        camera, true);
  }
  TemporaryDirectory dir;
};

TEST_F(Clouds, OrganizedGiveTheDepthImageThatTheyWereMadeOfToTheBit) {
  for (std::uint64_t seed = 0; seed < 240; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Camera camera{random_intrinsics(random), random_pose(random)};
    const Intrinsics& k = camera.intrinsics;
    const DepthImage depth = random_depth(random, k);
    const Points points = points_of(depth, k, random.below(2) ? not_a_point : Eigen::Vector3d::Zero().eval());
    const CloudWriter writer{all_cloud_encodings[seed % 6], seed, random.below(2) == 0};
    const auto width = static_cast<std::size_t>(k.width), height = static_cast<std::size_t>(k.height);
    EXPECT_EQ(depth_of(writer, points, width, height, camera), depth);
    EXPECT_EQ(depth_of(writer, points, points.size(), 1, camera), depth) << "a point a pixel, not organized";
  }
}

TEST_F(Clouds, OfAnyOrderAreProjectedAndTheNearestPointCounts) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Camera camera{random_intrinsics(random), random_pose(random)};
    const Intrinsics& k = camera.intrinsics;
    const DepthImage depth = random_depth(random, k);
    Points points = points_of(depth, k, not_a_point);
    // Farther ones on the same rays, and some outside the image.
    for (std::size_t i = k.height; i-- > 0;)
      if (points[i].allFinite()) points.push_back(points[i] * random.uniform(1.001, 2.0));
    points.emplace_back(10.0, 0.0, 0.5);
    points.emplace_back(0.0, 0.0, -0.5);
    for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random.below(i)]);
    const CloudWriter writer{all_cloud_encodings[seed % 6], seed};
    EXPECT_EQ(depth_of(writer, points, points.size(), 1, camera), depth);
  }
}

TEST_F(Clouds, InTheWorldAreTurnedIntoTheCamera) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Camera camera{random_intrinsics(random), random_pose(random)};
    const Intrinsics& k = camera.intrinsics;
    const DepthImage depth = random_depth(random, k);
    Points points = points_of(depth, k, not_a_point);
    const bool by_viewpoint = seed % 6 < 3 && random.below(2), mm = random.below(2);
    for (Eigen::Vector3d& p : points) p = (mm ? 1000.0 : 1.0) * (camera.world_from_camera * p);
    Eigen::Isometry3d viewpoint = camera.world_from_camera;
    if (mm) viewpoint.translation() *= 1000.0;
    const CloudWriter writer{all_cloud_encodings[seed % 6], seed, true,
                             by_viewpoint ? viewpoint_line(viewpoint) : ""};
    const CloudReading reading{by_viewpoint ? CloudFrame::camera : CloudFrame::world,
                               mm ? LengthUnit::millimetres : LengthUnit::metres};
    const DepthImage read = depth_of(writer, points, static_cast<std::size_t>(k.width),
                                     static_cast<std::size_t>(k.height), camera, reading);
    for (std::size_t i = 0; i < depth.size(); ++i) ASSERT_NEAR(read[i], depth[i], 1e-6);
  }
}

TEST_F(Clouds, PlyMayNameThePointOfEachPixel) {
  const auto cloud = read_cloud(dir.write(
      "grid.PLY",
      "ply\nformat ascii 1.0\nobj_info num_cols 2\nobj_info num_rows 2\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nelement range_grid 4\nproperty list uchar int vertex_indices\n"
      "end_header\n0 0 1\n0 0 2\n0 0 3\n1 2\n0\n1 0\n1 1\n"));
  ASSERT_TRUE(cloud.grid);
  EXPECT_EQ(cloud.grid->width, 2U);
  ASSERT_EQ(cloud.points.size(), 4U);
  EXPECT_EQ(cloud.points[0].z(), 3.0);
  EXPECT_TRUE(cloud.points[1].isZero());
  EXPECT_EQ(cloud.points[3].z(), 2.0);
}

/// Clouds taken in a wrong way, each of which must be refused with the remedy that helps.
class WrongClouds : public Clouds {
 protected:
  WrongClouds() {
    Random random(7);
    camera.intrinsics = {40, 30, 50, 50, 19.5, 14.5};
    camera.world_from_camera = Eigen::Isometry3d(Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitX()));
    camera.world_from_camera.translation() << 0.3, -0.6, 0.8;
    points = points_of(random_depth(random, camera.intrinsics), camera.intrinsics, not_a_point);
  }
  /// The complaint about the points as a map moves them, organized or not.
  template <typename Map>
  std::string refusal(bool organized, const Map& map, const CloudReading& reading = {},
                      const std::string& viewpoint = "") {
    Points moved;
    for (const Eigen::Vector3d& p : points) moved.push_back(map(p));
    if (!organized) std::reverse(moved.begin(), moved.end());
    const CloudWriter writer{CloudEncoding::pcd_binary, 1, true, viewpoint};
    const std::string message = input_error(
        [&] { depth_of(writer, moved, organized ? 40 : moved.size(), organized ? 30 : 1, camera, reading); });
    EXPECT_THAT(message, StartsWith((dir.path() / "cloud.pcd: ").string()));
    return message;
  }
  Camera camera;
  Points points;
};

TEST_F(WrongClouds, NameTheRemedy) {
  using Vector = Eigen::Vector3d;
  const auto same = [](const Vector& p) { return p; };
  const auto in_world = [&](const Vector& p) -> Vector { return camera.world_from_camera * p; };
  for (const bool organized : {true, false}) {
    SCOPED_TRACE(organized);
    const auto what = HasSubstr(organized ? "lie on their own pixels" : "points lie in front of");
    EXPECT_THAT(refusal(organized, in_world), AllOf(what, HasSubstr("set observation.cloud_frame: world")));
    EXPECT_THAT(refusal(organized, same, {.frame = CloudFrame::world}),
                AllOf(what, HasSubstr("set observation.cloud_frame: camera")));
    EXPECT_THAT(refusal(organized, [](const Vector& p) -> Vector { return 1000.0 * p; }),
                HasSubstr("set observation.cloud_unit: mm"));
    EXPECT_THAT(refusal(organized, same, {.unit = LengthUnit::millimetres}),
                HasSubstr("set observation.cloud_unit: m"));
    EXPECT_THAT(refusal(organized, [&](const Vector& p) -> Vector { return 1000.0 * in_world(p); },
                        {.frame = CloudFrame::world}),
                AllOf(what, HasSubstr("set observation.cloud_unit: mm")));
    EXPECT_THAT(refusal(organized, [](const Vector& p) { return Vector(p.z(), -p.x(), -p.y()); }),
                AllOf(what, HasSubstr("x forward, y left, z up")));
    EXPECT_THAT(refusal(organized, [](const Vector& p) { return Vector(p.x(), -p.y(), -p.z()); }),
                AllOf(what, HasSubstr("z backward")));
    EXPECT_THAT(refusal(organized, same, {}, "VIEWPOINT 0 0 -3 0 1 0 0\n"),
                AllOf(what, HasSubstr("VIEWPOINT to 0 0 0 1 0 0 0")));
    EXPECT_THAT(
        refusal(organized, [&](const Vector& p) -> Vector { return camera.world_from_camera.inverse() * p; },
                {.frame = CloudFrame::world}),
        AllOf(what, HasSubstr("world_from_camera looks like its inverse")));
  }
  EXPECT_THAT(refusal(true, [](const Vector& p) { return Vector(0.5 * p.x(), 0.5 * p.y(), p.z()); }),
              AllOf(HasSubstr("median"), HasSubstr("they fit fx 100.00, fy 100.00, cx 19.50, cy 14.50")));
  EXPECT_THAT(refusal(false, [](const Vector&) { return Vector(no_number, 1.0, 1.0); }),
              HasSubstr("none of its 1200 points is a reading"));
}

TEST_F(Clouds, HostileFilesAreRefusedAtOnce) {
  const auto refused = [&](const char* name, const std::string& bytes) {
    return input_error([&] { read_cloud(dir.write(name, bytes)); });
  };
  const auto pcd = [&](const std::string& from, const std::string& to, CloudEncoding encoding) {
    return refused("cloud.pcd",
                   replaced(CloudWriter{encoding}.write(Points(6, {0.0, 0.0, 1.0}), 3, 2), from, to));
  };
  for (const CloudEncoding encoding :
       {CloudEncoding::pcd_ascii, CloudEncoding::pcd_binary, CloudEncoding::pcd_compressed}) {
    // 10^9 points take 12 GB, if anybody took them.
    EXPECT_THAT(pcd("WIDTH 3\nHEIGHT 2", "WIDTH 1000000000\nHEIGHT 1", encoding), HasSubstr("WIDTH"));
    EXPECT_THAT(pcd("WIDTH 3\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 6",
                    "WIDTH 16384\nHEIGHT 16384\nPOINTS 268435456", encoding),
                AllOf(HasSubstr("cloud.pcd: "), HasSubstr("write the cloud again")));
    EXPECT_THAT(pcd("WIDTH 3\nHEIGHT 2", "WIDTH 18446744073709551615\nHEIGHT 2", encoding),
                HasSubstr("whole number"));
    EXPECT_THAT(pcd("WIDTH 3\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 6",
                    "WIDTH 200000000\nHEIGHT 200000000", encoding),
                HasSubstr("promises 40000000000000000 points"));
    EXPECT_THAT(pcd("POINTS 6", "POINTS 7", encoding), HasSubstr("7 POINTS but WIDTH 3"));
    EXPECT_THAT(pcd("VIEWPOINT 0 0 0 1", "VIEWPOINT 0 0 0 0", encoding), HasSubstr("VIEWPOINT is no pose"));
    EXPECT_THAT(pcd("VIEWPOINT 0 0 0 1", "VIEWPOINT 0 nan 0 1", encoding), HasSubstr("VIEWPOINT is no pose"));
    EXPECT_THAT(pcd(" x", " w", encoding), HasSubstr("has points without x"));
    EXPECT_THAT(pcd("TYPE", "TYPE F", encoding), HasSubstr("values of TYPE"));
    EXPECT_THAT(pcd(" F", " I", encoding), HasSubstr("is no single float"));
    EXPECT_THAT(pcd("COUNT", "COUNT 1", encoding), HasSubstr("values of COUNT"));
    EXPECT_THAT(pcd("DATA ", "DATA x", encoding), HasSubstr("must be ascii, binary"));
    EXPECT_THAT(pcd("WIDTH 3", "WIDER 3", encoding), HasSubstr("\"WIDER 3\""));
  }
  EXPECT_THAT(pcd("DATA ascii\n", "DATA ascii\n\n1 2", CloudEncoding::pcd_ascii), HasSubstr("line with too"));
  EXPECT_THAT(refused("cloud.pcd", "hello"), HasSubstr("\"hello\""));
  EXPECT_THAT(refused("cloud.xyz", "0 0 1\n"), HasSubstr("give a .pcd or .ply file"));
  EXPECT_THAT(refused("cloud.ply",
                      "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\n"
                      "property float y\nproperty float z\nend_header\n"),
              HasSubstr("is truncated"));
  EXPECT_THAT(input_error([&] { read_cloud(dir.path() / "none.pcd"); }), HasSubstr("no such file"));
}

TEST_F(Clouds, DamagedFilesLoadOrAreRefusedAndNothingElse) {
  const Camera camera{{8, 6, 50, 50, 3.5, 2.5}};
  for (std::uint64_t seed = 0; seed < 1200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const CloudWriter writer{all_cloud_encodings[seed % 6], seed};
    std::string bytes = writer.write(
        points_of(random_depth(random, camera.intrinsics), camera.intrinsics, not_a_point), 8, 6);
    const bool in_header = random.below(2);
    if (random.below(3) == 0) bytes.resize(random.below(bytes.size()));
    for (std::uint64_t k = random.below(5); k > 0 && !bytes.empty(); --k)
      bytes[random.below(in_header ? std::min<std::size_t>(bytes.size(), 250) : bytes.size())] =
          static_cast<char>(random.below(256));
    const auto path = dir.write(std::string("cloud") + writer.ending(), bytes);
    try {
      const DepthImage depth = read_cloud_depth(path, {}, camera, true);
      EXPECT_EQ(depth.size(), 48U);
      for (const float z : depth.data()) EXPECT_TRUE(z >= 0.0F && std::isfinite(z));
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), StartsWith(path.string() + ": "));
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    } catch (const std::exception& e) {
      ADD_FAILURE() << "not an InputError: " << e.what();
    }
  }
}

TEST_F(Clouds, StandInASceneFileForTheDepthImage) {
  write_scene_files(dir);
  const Intrinsics k{8, 6, 525.0, 526, 3.5, 2.5};
  Random random(3);
  const DepthImage depth = random_depth(random, k);
  const CloudWriter writer{CloudEncoding::pcd_compressed, 5};
  dir.write("cloud.pcd", writer.write(points_of(depth, k, not_a_point), 8, 6));
  const std::string of_depth = "  depth: images/depth.png\n  depth_scale: 0.001\n";
  const auto scene_with = [&](const std::string& lines) {
    return dir.write("scene.yaml", replaced(scene_text, of_depth, lines));
  };
  const Scene scene = read_scene(scene_with("  cloud: cloud.pcd\n"));
  EXPECT_EQ(scene.depth, depth);
  EXPECT_EQ(scene.depth_scale, 0.001);
  EXPECT_EQ(read_scene(scene_with("  cloud: cloud.pcd\n  cloud_unit: m\n  cloud_frame: camera\n"
                                  "  depth_scale: 0.0001\n"))
                .depth_scale,
            0.0001);
  const auto refused = [&](const std::string& lines) {
    const auto path = scene_with(lines);
    return input_error([&] { read_scene(path); });
  };
  EXPECT_THAT(refused("  cloud: cloud.pcd\n  cloud_unit: cm\n"),
              HasSubstr("observation.cloud_unit: \"cm\" is no unit"));
  EXPECT_THAT(refused("  cloud: cloud.pcd\n  cloud_frame: sensor\n"),
              HasSubstr("observation.cloud_frame: \"sensor\" is no frame; give camera or world"));
  EXPECT_THAT(refused("  cloud: cloud.pcd\n" + of_depth), HasSubstr("observation.depth: stands beside"));
  EXPECT_THAT(refused(of_depth + "  cloud_frame: world\n"),
              HasSubstr("observation.cloud_frame: there is no observation.cloud"));
  EXPECT_THAT(refused("  cloud: cloud.pcd\n  cloud_unit: mm\n"),
              AllOf(HasSubstr("scene.yaml: observation.cloud: "), HasSubstr("cloud_unit: m")));
  EXPECT_THAT(refused("  cloud: none.pcd\n"), HasSubstr("no such file"));
}

}  // namespace
}  // namespace perch
