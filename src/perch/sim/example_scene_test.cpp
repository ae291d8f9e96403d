#include "perch/sim/example_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "perch/io/mesh_file.hpp"
#include "perch/io/png.hpp"
#include "perch/io/scene_file.hpp"
#include "perch/model/solid_volume.hpp"
#include "perch/model/surface_samples.hpp"
#include "perch/sim/footprint.hpp"
#include "perch/sim/parametric_models.hpp"
#include "perch/sim/scene_folder.hpp"

namespace perch {
namespace {

namespace fs = std::filesystem;

const fs::path committed = fs::path(PERCH_EXAMPLES_DIR) / "tabletop";

/// A folder that is gone when the test is.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name) : path_(fs::path(testing::TempDir()) / name) {
    fs::remove_all(path_);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Relative path to bytes.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream in(entry.path(), std::ios::binary);
    files[fs::relative(entry.path(), folder).generic_string()] = {std::istreambuf_iterator<char>(in), {}};
  }
  return files;
}

TEST(ExampleScene, IsWhatItsGeneratorWrites) {
  const TemporaryFolder folder("perch_example_again");
  write_scene_folder(folder.path(), tabletop_example(), tabletop_example_comment());
  const auto made = files_of(folder.path()), kept = files_of(committed);
  std::size_t total = 0;
  for (const auto& [name, bytes] : made) {
    ASSERT_TRUE(kept.contains(name)) << name << ": run script/make_example";
    EXPECT_TRUE(kept.at(name) == bytes) << name << " differs: run script/make_example";
    total += bytes.size();
  }
  EXPECT_LT(total, 600'000U);
  for (const auto& [name, bytes] : kept)
    EXPECT_TRUE(made.contains(name) || !name.starts_with("models/"))
        << name << " belongs to no object any more";
}

TEST(ExampleScene, ReadsBackAsItWasMade) {
  const SimulatedScene made = tabletop_example();
  const Scene read = read_scene(committed / "scene.yaml");
  EXPECT_EQ(read.depth, depth_from_counts(counts_from_depth(made.scene.depth, 0.0001), 0.0001));
  EXPECT_TRUE(read.camera.world_from_camera.isApprox(made.scene.camera.world_from_camera, 1e-12));
  EXPECT_EQ(read.table_height, 0.0);
  ASSERT_EQ(read.objects.size(), 5U);
  ASSERT_EQ(read.truth.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const SceneModel &a = made.scene.models[made.scene.objects[i].model],
                     &b = read.models[read.objects[i].model];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.symmetry, b.symmetry);
    EXPECT_EQ(read.truth[i].model, read.objects[i].model);
    EXPECT_EQ(read.truth[i].pose, made.scene.truth[i].pose);
    EXPECT_EQ(a.mesh.triangles.size(), b.mesh.triangles.size());
    EXPECT_TRUE(is_closed(b.mesh));
    EXPECT_TRUE(a.mesh.bounds().isApprox(b.mesh.bounds(), 1e-7F));
  }
}

TEST(ExampleScene, HoldsWhatAnExampleShouldShow) {
  const SimulatedScene made = tabletop_example();
  const Scene& scene = made.scene;
  EXPECT_LT(scene.models.size(), scene.objects.size()) << "a model occurs twice";
  const auto some_model = [&](auto has) {
    return std::any_of(scene.models.begin(), scene.models.end(), has);
  };
  EXPECT_TRUE(some_model([](const SceneModel& m) { return m.symmetry.is_continuous(); }));
  EXPECT_TRUE(some_model([](const SceneModel& m) { return m.symmetry == Symmetry::none(); }));
  EXPECT_TRUE(some_model([](const SceneModel& m) { return m.symmetry.fold() > 1; }));
  int hidden = 0;
  for (const double fraction : made.visible_fractions) {
    EXPECT_GT(fraction, 0.2);
    EXPECT_TRUE(fraction <= 0.5 || fraction >= 0.6);
    hidden += fraction <= 0.5;
  }
  EXPECT_EQ(hidden, 1);
  for (int u = 0; u < 640; ++u) EXPECT_EQ(scene.depth(u, 0) + scene.depth(u, 479), 0.0F);
  for (int v = 0; v < 480; ++v) EXPECT_EQ(scene.depth(0, v) + scene.depth(639, v), 0.0F);
}

TEST(ExampleScene, ObjectsDontTouch) {
  const Scene scene = tabletop_example().scene;
  for (const TruthPose& a : scene.truth) {
    const SolidVolume solid(scene.models[a.model].mesh, 0.02);
    for (const TruthPose& b : scene.truth) {
      if (&a == &b) continue;
      EXPECT_GT(gap(Footprint(scene.models[a.model].mesh).at(a.pose),
                    Footprint(scene.models[b.model].mesh).at(b.pose)),
                0.003);
      const Eigen::Isometry3d a_from_b = world_from_model(a.pose, 0).inverse() * world_from_model(b.pose, 0);
      for (const Eigen::Vector3f& p : sample_surface(scene.models[b.model].mesh, 0.004F))
        ASSERT_LE(solid.depth_lower_bound((a_from_b * p.cast<double>()).cast<float>()), 0.0F);
    }
  }
}

TEST(SceneFolder, KeepsWhatIsOptionalAndPriors) {
  const TemporaryFolder folder("perch_optional_scene");
  SimulatedScene made = tabletop_example();
  made.scene.objects[1].optional = made.scene.objects[4].optional = true;
  for (const TruthPose& truth : made.scene.truth)
    made.scene.priors.push_back({truth.model, {truth.pose.x + 0.01, -truth.pose.y, 1.0 / 3.0}});
  write_scene_folder(folder.path(), made, "two lines\nof comment");
  const Scene read = read_scene(folder.path() / "scene.yaml");
  ASSERT_EQ(read.objects.size(), made.scene.objects.size());
  for (std::size_t i = 0; i < read.objects.size(); ++i)
    EXPECT_EQ(read.objects[i].optional, made.scene.objects[i].optional) << i;
  ASSERT_EQ(read.priors.size(), made.scene.priors.size());
  for (std::size_t i = 0; i < read.priors.size(); ++i) {
    EXPECT_EQ(read.priors[i].model, made.scene.priors[i].model);
    EXPECT_EQ(read.priors[i].pose, made.scene.priors[i].pose);
  }
  EXPECT_EQ(read.truth.size(), made.scene.truth.size());
}

TEST(SceneFolder, EveryModelSurvivesItsFile) {
  const TemporaryFolder folder("perch_model_files");
  fs::create_directories(folder.path());
  for (const std::string& name : household_model_names()) {
    const Mesh mesh = household_model(name).mesh;
    const fs::path file = folder.path() / (name + ".ply");
    std::ofstream(file, std::ios::binary) << encode_ply(mesh);
    const Mesh read = read_mesh(file, LengthUnit::metres);
    EXPECT_EQ(read.triangles.size(), mesh.triangles.size()) << name;
    EXPECT_TRUE(is_closed(read)) << name;
    EXPECT_NEAR(signed_volume(read) / signed_volume(mesh), 1.0, 1e-6) << name;
  }
}

}  // namespace
}  // namespace perch
