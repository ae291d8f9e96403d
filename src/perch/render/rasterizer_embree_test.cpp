#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "perch/core/random.hpp"
#include "perch/render/rasterizer.hpp"

namespace perch {
namespace {

constexpr float same_depth = 1e-4F;  ///< metres
constexpr double same_pixel = 0.01;  ///< how far a ray may be shifted to account for a difference, pixels

/// Casts rays at a mesh that stands in the camera frame, by Embree.
class RayCaster {
 public:
  RayCaster(const Mesh& mesh, const Eigen::Isometry3d& camera_from_model)
      : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
      Eigen::Map<Eigen::Vector3f>(vertices + 3 * i) =
          (camera_from_model * mesh.vertices[i].cast<double>()).cast<float>();
    auto* triangles = static_cast<std::array<std::uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~RayCaster() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  /// Depth at any point of the image, pixels.
  float depth(const Intrinsics& k, double u, double v) const {
    RTCRayHit ray = ray_through(k, u, v);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
    return hit_depth(ray);
  }
  Image<float> depth(const Intrinsics& k) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    Image<float> image(k.width, k.height, no_surface);
    std::vector<RTCRayHit> rays(static_cast<std::size_t>(k.width));
    for (int v = 0; v < k.height; ++v) {
      for (int u = 0; u < k.width; ++u) rays[static_cast<std::size_t>(u)] = ray_through(k, u, v);
      rtcIntersect1M(scene_, &context, rays.data(), static_cast<unsigned>(k.width), sizeof(RTCRayHit));
      std::transform(rays.begin(), rays.end(), image.row(v), hit_depth);
    }
    return image;
  }

 private:
  static RTCRayHit ray_through(const Intrinsics& k, double u, double v) {
    RTCRayHit ray{};
    ray.ray.dir_x = static_cast<float>((u - k.cx) / k.fx);
    ray.ray.dir_y = static_cast<float>((v - k.cy) / k.fy);
    ray.ray.dir_z = 1.0F;  // so that the ray's parameter is the depth
    ray.ray.tnear = Rasterizer::near_plane;
    ray.ray.tfar = no_surface;
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return ray;
  }
  static float hit_depth(const RTCRayHit& ray) {
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? no_surface : ray.ray.tfar;
  }

  RTCDevice device_;
  RTCScene scene_;
};

/// True where rays within `same_pixel` of the pixel's centre see the depth z, or depths on both sides of it.
bool seen_nearby(const RayCaster& caster, const Intrinsics& k, int u, int v, float z) {
  float lowest = no_surface, highest = 0.0F;
  bool any_miss = false;
  const auto look = [&](double du, double dv) {
    const float seen = caster.depth(k, u + du, v + dv);
    if (seen == no_surface) {
      any_miss = true;
    } else {
      lowest = std::min(lowest, seen);
      highest = std::max(highest, seen);
    }
  };
  look(0.0, 0.0);
  constexpr int directions = 16;
  for (const double radius : {0.01, 0.03, 0.1, 0.3, 1.0})
    for (int i = 0; i < directions; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / directions;
      look(same_pixel * radius * std::cos(angle), same_pixel * radius * std::sin(angle));
    }
  if (z == no_surface) return any_miss;
  return z >= lowest - same_depth && z <= highest + same_depth;
}

struct Agreement {
  std::size_t both = 0;         ///< pixels that both cover
  std::size_t same = 0;         ///< of these, with the same depth
  std::size_t unexplained = 0;  ///< pixels that differ otherwise than by rounding of the silhouette
};

Agreement compare(const Mesh& mesh, const Intrinsics& k, const Eigen::Isometry3d& camera_from_model) {
  const RayCaster caster(mesh, camera_from_model);
  const Image<float> truth = caster.depth(k);
  const DepthPatch patch = Rasterizer(k).render(mesh, camera_from_model);
  Agreement result;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u) {
      const float expected = truth(u, v), got = patch.at_or_none(u, v);
      if (expected == no_surface && got == no_surface) continue;
      const bool both = expected != no_surface && got != no_surface;
      const bool same = both && std::abs(expected - got) < same_depth;
      result.both += both;
      result.same += same;
      if (!same && !seen_nearby(caster, k, u, v, got)) ++result.unexplained;
    }
  return result;
}

/// Where the camera stands: its distance from the middle of the mesh, in radii of the sphere around the mesh,
/// and how far from the image's middle the mesh may lie, in halves of the image.
struct View {
  const char* name;
  double nearest, farthest, offset;
};
constexpr std::array<View, 5> views{{{"whole", 3.0, 6.0, 0.3},
                                     {"far", 6.0, 20.0, 0.9},
                                     {"partly outside", 2.0, 5.0, 1.2},
                                     {"very near", 1.0, 1.6, 0.6},
                                     {"from inside", 0.0, 0.9, 0.2}}};

constexpr std::array<Intrinsics, 2> cameras{
    {{640, 480, 525.0, 525.0, 319.5, 239.5}, {640, 480, 1066.8, 1067.5, 312.99, 241.31}}};

Eigen::Isometry3d random_pose(const Mesh& mesh, const Intrinsics& k, const View& view, Random& random) {
  const Eigen::AlignedBox3d box = mesh.bounds().cast<double>();
  const double depth = random.uniform(view.nearest, view.farthest) * box.diagonal().norm() / 2.0;
  const double x = view.offset * random.uniform(-0.5, 0.5) * k.width / k.fx;
  const double y = view.offset * random.uniform(-0.5, 0.5) * k.height / k.fy;
  const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
  return Eigen::Translation3d(depth * Eigen::Vector3d(x, y, 1.0)) * turn.normalized() *
         Eigen::Translation3d(-box.center());
}

/// Every view of the mesh, by one camera or the other, at random poses.
void expect_agreement(const Mesh& mesh, const std::string& name, std::uint64_t seed) {
  std::size_t covered = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Intrinsics& k = cameras[(i + seed) % cameras.size()];
    const std::uint64_t pose_seed = 10 * seed + i;
    Random random(pose_seed);
    const Agreement found = compare(mesh, k, random_pose(mesh, k, views[i], random));
    const std::string where =
        fmt::format("{}, view '{}', fx {}, seed {}", name, views[i].name, k.fx, pose_seed);
    EXPECT_EQ(found.unexplained, 0U) << where;
    EXPECT_LE(found.both - found.same, 1 + found.both / 1000)
        << where << ": " << found.same << " of " << found.both << " pixels have the same depth";
    covered += found.both;
  }
  EXPECT_GT(covered, 1000U) << name << " was hardly in view";
}

std::uint32_t number(std::size_t i) {
  return static_cast<std::uint32_t>(i);
}

Mesh box(const Eigen::Vector3f& size) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(size.cwiseProduct(Eigen::Vector3i(i & 1, (i >> 1) & 1, i >> 2).cast<float>() -
                                              Eigen::Vector3f::Constant(0.5F)));
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The surface that the line through (radius, height) sweeps about z.
Mesh revolved(const std::vector<Eigen::Vector2d>& profile, std::size_t around) {
  Mesh mesh;
  for (const Eigen::Vector2d& p : profile)
    for (std::size_t j = 0; j < around; ++j) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(around);
      mesh.vertices.push_back(
          Eigen::Vector3d(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y()).cast<float>());
    }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    for (std::size_t j = 0; j < around; ++j) {
      const std::size_t next = (j + 1) % around, a = i * around, b = a + around;
      mesh.triangles.push_back({number(a + j), number(a + next), number(b + j)});
      mesh.triangles.push_back({number(a + next), number(b + next), number(b + j)});
    }
  return mesh;
}

Mesh sphere(double radius, std::size_t rings) {
  std::vector<Eigen::Vector2d> profile;
  for (std::size_t i = 0; i <= rings; ++i) {
    const double angle = std::numbers::pi * static_cast<double>(i) / static_cast<double>(rings);
    profile.emplace_back(radius * std::sin(angle), -radius * std::cos(angle));
  }
  return revolved(profile, 2 * rings);
}

/// Long triangles of many widths, the thinnest a fraction of a pixel across. (In single precision the plane
/// of one 10,000 times as long as wide is not known to a tenth of a millimetre.)
Mesh needles(Random& random) {
  const auto anywhere = [&](double scale) -> Eigen::Vector3f {
    return scale * Eigen::Vector3d(random.normal(), random.normal(), random.normal()).cast<float>();
  };
  Mesh mesh;
  for (std::size_t i = 0; i < 600; ++i) {
    const Eigen::Vector3f a = anywhere(0.05), b = a + anywhere(0.05);
    const Eigen::Vector3f c = b + anywhere(std::pow(10.0, random.uniform(-3.5, -2.0)));
    mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
    mesh.triangles.push_back({number(3 * i), number(3 * i + 1), number(3 * i + 2)});
  }
  return mesh;
}

TEST(RasterizerAgainstEmbree, AgreesOnSimpleShapes) {
  Mesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.2F, 0, 0}, {0.2F, 0.3F, 0}, {0, 0.3F, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  Random random(3);
  expect_agreement(box({0.1F, 0.2F, 0.06F}), "box", 1);
  expect_agreement(box({3.0F, 0.05F, 0.04F}), "beam", 2);
  expect_agreement(sphere(0.05, 40), "sphere", 3);
  expect_agreement(sheet, "sheet", 4);
  expect_agreement(revolved({{0.04, 0.0}, {0.04, 0.15}}, 60), "open cylinder", 5);
  for (std::uint64_t seed = 6; seed < 12; ++seed) expect_agreement(needles(random), "needles", seed);
}

TEST(RasterizerAgainstEmbree, AgreesOnImagesOfAnySize) {
  const Mesh mesh = sphere(0.05, 20);
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 5}, {1, 300}, {1280, 2}, {1920, 1080}}) {
    const Intrinsics k{
        width, height, 0.8 * height + 3.0, 0.8 * height + 3.0, 0.5 * width - 0.3, 0.5 * height - 0.4};
    Eigen::Isometry3d pose(Eigen::Translation3d(0.001, 0.002, 0.1));
    const Agreement found = compare(mesh, k, pose);
    EXPECT_GT(found.both, 0U) << width << " x " << height;
    EXPECT_EQ(found.unexplained, 0U) << width << " x " << height;
  }
}

/// Reads what the test data's meshes are: binary PLY of x, y, z and of triangles, nothing else.
Mesh read_mesh(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::size_t vertices = 0, triangles = 0;
  int properties = 0;
  for (std::string line; std::getline(file, line) && line != "end_header";) {
    if (line.starts_with("element vertex ")) vertices = std::stoul(line.substr(15));
    if (line.starts_with("element face ")) triangles = std::stoul(line.substr(13));
    properties += line.starts_with("property float ");
    if (line.starts_with("format ") && line != "format binary_little_endian 1.0") properties = 99;
  }
  if (properties != 3) throw std::runtime_error(path.string() + " is no plain binary PLY");
  Mesh mesh;
  for (mesh.vertices.resize(vertices); Eigen::Vector3f & p : mesh.vertices)
    file.read(reinterpret_cast<char*>(p.data()), 3 * sizeof(float));
  for (mesh.triangles.resize(triangles); auto& triangle : mesh.triangles) {
    if (file.get() != 3) throw std::runtime_error(path.string() + " has a face that is no triangle");
    file.read(reinterpret_cast<char*>(triangle.data()), sizeof(triangle));
  }
  if (!file || !mesh_fault(mesh).empty()) throw std::runtime_error(path.string() + " is cut short");
  return mesh;
}

/// One folder of the test data, with all below it.
class RasterizerOnDataHeavy : public testing::TestWithParam<const char*> {};

TEST_P(RasterizerOnDataHeavy, AgreesWithEmbree) {
  const char* data = std::getenv("PERCH_TEST_DATA");
  if (!data) GTEST_SKIP() << "PERCH_TEST_DATA does not name a folder of test data";
  const std::filesystem::path folder = std::filesystem::path(data) / GetParam();
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " does not exist";
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".ply") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  EXPECT_FALSE(paths.empty()) << folder;
  for (std::size_t i = 0; i < paths.size(); ++i)
    expect_agreement(read_mesh(paths[i]), paths[i].lexically_relative(folder).string(), i);
}

INSTANTIATE_TEST_SUITE_P(Folders, RasterizerOnDataHeavy,
                         testing::Values("models", "sim/models", "sim_clean/models", "sim_chess/models",
                                         "chess", "real"));

}  // namespace
}  // namespace perch
