#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "perch/core/random.hpp"
#include "perch/io/mesh_file.hpp"
#include "perch/localize/prepare.hpp"
#include "perch/localize/symmetry_search.hpp"
#include "perch/model/surface_distance.hpp"
#include "perch/render/rasterizer.hpp"
#include "perch/sim/chess_pieces.hpp"
#include "perch/sim/model_catalogue.hpp"

// Symmetries that are found against what depth cameras see at both yaws, by brute force.
namespace perch {
namespace {

using std::numbers::pi;
constexpr double delta = 0.005;
constexpr double negligible = 0.005;  // share of pixels, at outlines

std::vector<SceneModel> all_models() {
  std::vector<SceneModel> models;
  for (const std::string& name : catalogue_model_names()) models.push_back(catalogue_model(name));
  for (const std::string& name : chess_model_names()) models.push_back(chess_model(name));
  return models;
}

/// How far the points that one rendering shows lie from those of another, sorted, metres; capped by what the
/// search window shows.
class Views {
 public:
  explicit Views(const Mesh& mesh) : mesh_(mesh), radius_(mesh.bounds().diagonal().norm()) {}

  std::vector<float> differences(double turn, double azimuth, double elevation) const {
    const DepthPatch a = look(azimuth, elevation), b = look(azimuth + turn, elevation);
    const RaySlopes rays(intrinsics_);
    std::vector<float> out;
    for (int v = a.window.v0; v < a.window.v1; v += 4)
      for (int u = a.window.u0; u < a.window.u1; u += 4) {
        if (!(a.at(u, v) < no_surface)) continue;
        const Eigen::Vector3f p = rays.point(u, v, a.at(u, v));
        float nearest = 1.0F;
        for (int y = v - reach; y <= v + reach; ++y)
          for (int x = u - reach; x <= u + reach; ++x)
            if (const float z = b.at_or_none(x, y); z < no_surface)
              nearest = std::min(nearest, (rays.point(x, y, z) - p).norm());
        out.push_back(nearest);
      }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  static constexpr int reach = 6;  // pixels of about a millimetre

  DepthPatch look(double azimuth, double elevation) const {
    const double distance = std::max(0.6, 1.5 * radius_);
    const Eigen::Vector3d outwards(std::cos(elevation) * std::cos(azimuth),
                                   std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear().col(0) = Eigen::Vector3d(-std::sin(azimuth), std::cos(azimuth), 0.0);
    pose.linear().col(2) = -outwards;
    pose.linear().col(1) = pose.linear().col(2).cross(pose.linear().col(0));
    pose.translation() =
        mesh_.bounds().center().cast<double>().z() * Eigen::Vector3d::UnitZ() + distance * outwards;
    return Rasterizer(intrinsics_).render(mesh_, pose.inverse());
  }

  const Mesh& mesh_;
  double radius_;
  Intrinsics intrinsics_{480, 480, 525, 525, 239.5, 239.5};
};

/// The share of rendered points beyond a distance in the worst of a few views, or in the first where it is
/// not negligible.
double worst_share_beyond(const Mesh& mesh, double turn, double distance) {
  const Views views(mesh);
  double worst = 0.0;
  for (const double elevation : {0.15, 0.9})
    for (const double azimuth : {0.3, 1.9}) {
      const auto d = views.differences(turn, azimuth, elevation);
      const auto beyond = d.end() - std::upper_bound(d.begin(), d.end(), static_cast<float>(distance));
      worst = std::max(worst,
                       static_cast<double>(beyond) / static_cast<double>(std::max<std::size_t>(1, d.size())));
      if (worst > negligible) return worst;  // drawing takes long, and one view tells shapes apart
    }
  return worst;
}

TEST(SymmetrySearch, RenderingsExplainEachOtherWhereItIsFoundAndElseDoNot) {
  for (const SceneModel& model : all_models()) {
    SCOPED_TRACE(model.name);
    const Symmetry found = find_symmetry(model.mesh, delta).symmetry;
    EXPECT_EQ(found.name(), model.symmetry.name());
    if (found.is_continuous()) {
      for (const double turn : {0.7, 2.3})
        EXPECT_LE(worst_share_beyond(model.mesh, turn, delta), negligible) << turn;
      continue;
    }
    if (found.fold() > 1) {
      EXPECT_LE(worst_share_beyond(model.mesh, found.period(), delta), negligible);
    }
    // Surfaces lie no farther apart than renderings of them.
    const double next = found.fold() == 1 ? pi : 0.5 * found.period();
    EXPECT_GT(worst_share_beyond(model.mesh, next, 0.45 * delta), negligible) << "twice as fine is as good";
  }
}

Mesh turned_box(double x, double y, double z, double turn, const Eigen::Vector2d& at) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d corner((i & 1 ? 0.5 : -0.5) * x, (i & 2 ? 0.5 : -0.5) * y);
    const Eigen::Vector2d p = at + Eigen::Rotation2Dd(turn) * corner;
    mesh.vertices.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                               static_cast<float>(i & 4 ? z : 0.0));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A prism with so many sides, and a pin on it: a box beside the axis.
Mesh pinned_prism(int sides, double radius, double height, double pin) {
  Mesh mesh;
  if (pin > 0.0) mesh = turned_box(pin, pin, height + 0.012, 0.3, {0.8 * radius, 0.0});
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto n = static_cast<std::uint32_t>(sides);
  for (std::uint32_t i = 0; i < n; ++i)
    for (const double z : {0.0, height}) {
      const double a = 2.0 * pi * i / n;
      mesh.vertices.push_back(Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), z).cast<float>());
    }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = first + 2 * i, b = first + 2 * ((i + 1) % n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    if (i == 0 || i + 1 == n) continue;
    mesh.triangles.push_back({first, b, a});
    mesh.triangles.push_back({first + 1, a + 1, b + 1});
  }
  return mesh;
}

TEST(SymmetrySearch, FollowsTheToleranceOfBoxesAndPrisms) {
  Random random(1);
  for (int i = 0; i < 2; ++i) {
    const double turn = random.uniform(0.0, pi);
    // Quarter turns move a face by half of the sides' difference: 4-fold up to delta / 2.
    EXPECT_EQ(find_symmetry(turned_box(0.08, 0.08 + 0.9 * delta, 0.1, turn, {0, 0}), delta).symmetry.name(),
              "4");
    EXPECT_EQ(find_symmetry(turned_box(0.08, 0.08 + 1.3 * delta, 0.1, turn, {0, 0}), delta).symmetry.name(),
              "2");
  }
  for (const int sides : {3, 7, 12, 60}) {
    // A turn by half a side moves the middle of a side by radius (1 - cos(pi / sides)).
    const double unseen = 0.5 * delta / (1.0 - std::cos(pi / sides));
    SCOPED_TRACE(sides);
    if (unseen > 0.02) {
      const Mesh mesh = pinned_prism(sides, std::min(0.9 * unseen, 0.1), 0.1, 0.0);
      EXPECT_TRUE(find_symmetry(mesh, delta).symmetry.is_continuous());
    }
    if (unseen < 0.1) {
      const Mesh mesh = pinned_prism(sides, std::max(2.5 * unseen, 0.05), 0.1, 0.0);
      EXPECT_EQ(find_symmetry(mesh, delta).symmetry.name(), fmt::format("{}", sides));
    }
  }
}

TEST(SymmetrySearch, NeverLosesASmallPartThatStandsOut) {
  for (const double pin : {0.004, 0.002}) {
    EXPECT_TRUE(find_symmetry(pinned_prism(64, 0.05, 0.12, 0.0), delta).symmetry.is_continuous());
    EXPECT_EQ(find_symmetry(pinned_prism(64, 0.05, 0.12, pin), delta).symmetry.name(), "none") << pin;
  }
}

TEST(SymmetrySearch, OffersTheAxisThatTheOriginMisses) {
  const Eigen::Vector2d at(0.012, -0.003);
  const FoundSymmetry box = find_symmetry(turned_box(0.06, 0.1, 0.1, 0.4, at), delta);
  EXPECT_EQ(box.symmetry.name(), "none");
  ASSERT_TRUE(box.better_axis);
  EXPECT_EQ(box.better_axis->symmetry.name(), "2");
  EXPECT_LT((box.better_axis->at - at).norm(), 0.001);
  const FoundSymmetry centred = find_symmetry(turned_box(0.06, 0.1, 0.1, 0.4, {0.0, 0.0}), delta);
  EXPECT_EQ(centred.symmetry.name(), "2");
  EXPECT_FALSE(centred.better_axis);
}

TEST(SymmetrySearch, DistancesToASurfaceAreThoseOfBruteForce) {
  const Mesh mesh = catalogue_model("mug").mesh;
  const SurfaceDistance distance(mesh, 0.002);
  Random random(5);
  const Eigen::AlignedBox3d box = mesh.bounds().cast<double>();
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d p =
        box.min() +
        Eigen::Vector3d(random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1))
            .cwiseProduct(box.sizes());
    // The nearest of many points of each triangle.
    double least = 1.0;
    for (const auto& [ia, ib, ic] : mesh.triangles) {
      const Eigen::Vector3d a = mesh.vertices[ia].cast<double>(), b = mesh.vertices[ib].cast<double>(),
                            c = mesh.vertices[ic].cast<double>();
      if (((a + b + c) / 3.0 - p).norm() > least + 0.03) continue;
      constexpr int steps = 8;
      for (int k = 0; k <= steps; ++k)
        for (int l = 0; k + l <= steps; ++l)
          least = std::min(least, (a + (b - a) * k / steps + (c - a) * l / steps - p).norm());
    }
    const double answer = distance(p, 0.0);
    EXPECT_LE(answer, least + 0.002 * 2 / 3) << i;
    EXPECT_GE(answer, least - 0.0015) << i;
  }
}

TEST(Prepare, FindsWhatIsAskedForAndTellsTheTruth) {
  Scene scene;
  scene.models = {catalogue_model("can"), catalogue_model("carton")};
  for (SceneModel& model : scene.models) model.symmetry = Symmetry::none();
  scene.models[0].find_symmetry = true;
  scene.truth = {
      {0, {}, Symmetry::none(), true}, {0, {}, Symmetry::n_fold(3)}, {1, {}, Symmetry::none(), true}};
  scene = prepare(std::move(scene), Settings(), SerialExecutor());
  EXPECT_EQ(scene.models[0].symmetry, Symmetry::continuous());
  EXPECT_FALSE(scene.models[0].find_symmetry);
  EXPECT_EQ(scene.models[1].symmetry, Symmetry::none()) << "as given";
  EXPECT_EQ(scene.truth[0].symmetry, Symmetry::continuous());
  EXPECT_EQ(scene.truth[1].symmetry, Symmetry::n_fold(3)) << "its own";
  EXPECT_EQ(scene.truth[2].symmetry, Symmetry::none());
}

// What people say of the scanned meshes, where the mesh bears it out (docs/symmetry.md has the others).
TEST(SymmetrySearch, KnowsTheMeshesOfTheTestData) {
  const char* data = std::getenv("PERCH_TEST_DATA");
  if (!data) GTEST_SKIP() << "PERCH_TEST_DATA names no folder of test scenes";
  for (const auto& [name, symmetry] :
       std::vector<std::pair<std::string, std::string>>{{"models/002_master_chef_can", "continuous"},
                                                        {"models/007_tuna_fish_can", "continuous"},
                                                        {"models/024_bowl", "continuous"},
                                                        {"models/025_mug", "none"},
                                                        {"models/019_pitcher_base", "none"},
                                                        {"models/011_banana", "none"},
                                                        {"models/035_power_drill", "none"},
                                                        {"models/061_foam_brick", "2"},
                                                        {"chess/bishop", "continuous"},
                                                        {"chess/king", "continuous"},
                                                        {"chess/knight", "none"},
                                                        {"chess/pawn", "continuous"},
                                                        {"chess/queen", "continuous"},
                                                        {"chess/rook", "continuous"}}) {
    const auto path = std::filesystem::path(data) / (name + ".ply");
    EXPECT_EQ(
        find_symmetry(stood_on_ground(read_mesh(path, LengthUnit::metres, "unit")), delta).symmetry.name(),
        symmetry)
        << name;
  }
}

}  // namespace
}  // namespace perch
