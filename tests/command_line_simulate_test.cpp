#include "command_line_test_support.hpp"
#include "perch/io/scene_file.hpp"

// `perch simulate`: what it writes can be read, is the same each time, and is nothing where it is refused.
namespace perch::command_line {
namespace {

class Simulate : public ::testing::Test {
 protected:
  const fs::path& folder() const { return temporary_.path(); }

  Outcome run(Arguments options) const {
    options.insert(options.begin(), {"simulate", "--image", "160x120"});
    return run_program(folder(), options);
  }

  void refused(const Arguments& options, const std::vector<std::string>& words) const {
    SCOPED_TRACE(::testing::PrintToString(options));
    const auto before = contents(folder());
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.status, 2) << outcome;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.error_lines(), 1) << outcome;
    EXPECT_THAT(outcome.err, ::testing::Not(::testing::HasSubstr("internal error")));
    for (const std::string& word : words) EXPECT_THAT(outcome.err, ::testing::HasSubstr(word));
    EXPECT_EQ(contents(folder()), before) << "files were left behind or changed";
  }

 private:
  TemporaryFolder temporary_;
};

TEST_F(Simulate, WritesScenesThatCanBeRead) {
  const Outcome outcome = run({"-o", "set/a", "--scenes", "2", "--models", "can,mug,tea_box", "--objects",
                               "3", "--repeats", "2", "--table", "--picture"});
  ASSERT_EQ(outcome.status, 0) << outcome;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("2 scenes in set/a: 6 objects"));
  EXPECT_EQ(outcome.err, "");
  for (const std::string index : {"000000", "000001"}) {
    const fs::path scene_folder = folder() / "set/a" / index;
    const Scene scene = read_scene(scene_folder / "scene.yaml");
    const Json truth = Json::parse(bytes_of(scene_folder / "truth.json"));
    ASSERT_EQ(scene.objects.size(), 3U);
    ASSERT_EQ(scene.truth.size(), 3U);
    ASSERT_TRUE(scene.mask.has_value());
    // i + 1 at the pixels of object i.
    const auto counted = read_color(scene_folder / "masks.png", 160, 120);
    for (std::size_t i = 0; i < 3; ++i) {
      const TruthPose& pose = scene.truth[i];
      EXPECT_EQ(truth["names"][i], scene.models[pose.model].name);
      EXPECT_EQ(truth["poses"][i], (Json{pose.pose.x, pose.pose.y, pose.pose.yaw}));
      const auto pixels = std::count(counted.data().begin(), counted.data().end(),
                                     Rgb{static_cast<std::uint8_t>(i + 1), static_cast<std::uint8_t>(i + 1),
                                         static_cast<std::uint8_t>(i + 1)});
      EXPECT_EQ(truth["visible_pixels"][i], pixels);
      EXPECT_EQ(truth["visible"][i],
                truth["visible_pixels"][i].get<double>() / truth["alone_pixels"][i].get<double>());
    }
    for (const SceneModel& model : scene.models)
      EXPECT_EQ(truth["symmetry"][model.name], model.name == "can"   ? Json("continuous")
                                               : model.name == "mug" ? Json("none")
                                                                     : Json(4));
  }
  EXPECT_TRUE(fs::exists(folder() / "set/a/models/tea_box.ply"));
  EXPECT_TRUE(fs::exists(folder() / "set/a/picture.png"));
}

TEST_F(Simulate, TheSameBytesAtAnyNumberOfThreadsAndScenes) {
  const Arguments same{"--models", "can,mug,tea_box,glass,jar", "--seed", "7", "-q"};
  const auto made = [&](const std::string& name, Arguments options) {
    options.insert(options.end(), same.begin(), same.end());
    options.insert(options.end(), {"-o", name});
    const Outcome outcome = run(options);
    EXPECT_EQ(outcome.status, 0) << outcome;
    EXPECT_EQ(outcome.out + outcome.err, "");
    return contents(folder() / name);
  };
  const auto serial = made("a", {"--scenes", "4", "--threads", "1"});
  EXPECT_EQ(made("b", {"--scenes", "4", "--threads", "3"}), serial);
  const auto last = made("c", {"--scenes", "1", "--first", "3"});
  for (const auto& [name, hash] : last) EXPECT_EQ(serial.at(name), hash) << name;
  EXPECT_FALSE(last.contains("000002"));
  refused({"-o", "c", "--scenes", "1", "--first", "3"}, {"c/000003", "there already"});
  EXPECT_EQ(made("c", {"--scenes", "3"}), serial) << "what was missing is added";
}

TEST_F(Simulate, ModelsAlone) {
  const Outcome outcome = run({"-o", "m", "--models-only", "--layout", "chess"});
  ASSERT_EQ(outcome.status, 0) << outcome;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("knight"));
  EXPECT_EQ(contents(folder()).size(), 2U + 6U);
}

TEST_F(Simulate, Refusals) {
  refused({}, {"--output"});
  refused({"-o", "out", "--scenes", "0"}, {"--scenes '0'"});
  refused({"-o", "out", "--scenes", "-1"}, {"--scenes"});
  refused({"-o", "out", "--scenes", "2000000"}, {"--scenes"});
  refused({"-o", "out", "--scenes", "2", "--first", "999999"}, {"--scenes"});
  refused({"-o", "out", "--seed", "1.5"}, {"--seed"});
  refused({"-o", "out", "--threads", "5000"}, {"--threads"});
  refused({"-o", "out", "--objects", "3-"}, {"--objects"});
  refused({"-o", "out", "--objects", "5-3"}, {"objects 5-3"});
  refused({"-o", "out", "--objects", "3-5-7"}, {"--objects"});
  refused({"-o", "out", "--models", "can,anvil"}, {"--models", "anvil", "goblet"});
  refused({"-o", "out", "--models", ""}, {"--models"});
  refused({"-o", "out", "--models", "can", "--objects", "2"}, {"objects", "1 models"});
  refused({"-o", "out", "--repeats", "4"}, {"repeats 4"});
  refused({"-o", "out", "--visible", "0.5-1.5"}, {"visible 0.5-1.5"});
  refused({"-o", "out", "--visible", "half"}, {"--visible 'half'"});
  refused({"-o", "out", "--distance", "nan"}, {"distance"});
  refused({"-o", "out", "--elevation-deg", "90"}, {"elevation"});
  refused({"-o", "out", "--workspace", "0.4"}, {"--workspace", "AxB"});
  refused({"-o", "out", "--image", "100000x3"}, {"image"});
  refused({"-o", "out", "--layout", "shelf"}, {"--layout", "tabletop, chess"});
  refused({"-o", "out", "--layout", "chess", "--models", "can"}, {"--models", "--layout chess"});
  refused({"-o", "out", "--layout", "chess", "--objects", "33"}, {"objects 33-33", "32"});
  refused({"-o", "out", "--sensor", "lidar"}, {"--sensor", "time-of-flight"});
  refused({"-o", "out", "--set", "sensor.colour=1"}, {"sensor.colour", "sensor.disparity_noise"});
  refused({"-o", "out", "--set", "sensor.dropout_rate=2"}, {"sensor.dropout_rate is 2"});
  refused({"-o", "out", "--set", "sensor.dropout_rate"}, {"key=value"});
  // No room for them: nothing is left, not even a folder.
  refused({"-o", "new/out", "--scenes", "2", "--workspace", "0.05x0.05", "--models", "plate,carton",
           "--objects", "2"},
          {"new/out: scene 0: no scene in", "larger workspace"});
  write(folder() / "file", "in the way");
  refused({"-o", "file"}, {"file", "directory"});
  write(folder() / "other/models/can.ply", "another");
  refused({"-o", "other", "--models", "can,mug", "--objects", "1"}, {"can.ply", "another mesh"});
}

}  // namespace
}  // namespace perch::command_line
