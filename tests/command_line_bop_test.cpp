#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <set>
#include <sstream>

#include "command_line_test_support.hpp"

// `perch simulate --bop` and `perch localize --bop`: what the one writes the other finds, as BOP's own files
// say it.
namespace perch::command_line {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

Matrix3d matrix_of(const Json& rows) {
  Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = rows[static_cast<std::size_t>(i)].get<double>();
  return m;
}

Json rows_of(const Eigen::MatrixXd& m) {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < m.size(); ++i) out.push_back(m(i / m.cols(), i % m.cols()));
  return out;
}

Vector3d vector_of(const Json& list) {
  return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

/// A pose in millimetres.
struct BopPose {
  Matrix3d turn = Matrix3d::Identity();
  Vector3d shift = Vector3d::Zero();
};

/// A row of the results file, read by the description of the format alone.
struct Row {
  int scene_id, im_id, obj_id;
  double score, time;
  BopPose pose;
};

std::vector<double> numbers_in(const std::string& text) {
  std::istringstream words(text);
  std::vector<double> out;
  for (double number; words >> number;) out.push_back(number);
  return out;
}

std::vector<Row> rows_in(const std::string& csv) {
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "scene_id,im_id,obj_id,score,R,t,time");
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    std::istringstream parts(line);
    std::vector<std::string> fields;
    for (std::string field; std::getline(parts, field, ',');) fields.push_back(field);
    EXPECT_EQ(fields.size(), 7U) << line;
    const auto turn = numbers_in(fields.at(4)), shift = numbers_in(fields.at(5));
    EXPECT_EQ(turn.size(), 9U);
    EXPECT_EQ(shift.size(), 3U);
    Row row{std::stoi(fields[0]), std::stoi(fields[1]), std::stoi(fields[2]),
            std::stod(fields[3]), std::stod(fields[6]), {}};
    for (int i = 0; i < 9; ++i) row.pose.turn(i / 3, i % 3) = turn[static_cast<std::size_t>(i)];
    row.pose.shift = Vector3d(shift[0], shift[1], shift[2]);
    rows.push_back(row);
  }
  return rows;
}

/// The symmetries of a model, those about an axis in steps of two degrees.
std::vector<BopPose> symmetries_of(const Json& info) {
  std::vector<BopPose> all(1);
  if (info.contains("symmetries_discrete"))
    for (const Json& m : info["symmetries_discrete"]) {
      BopPose motion;
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) motion.turn(i, j) = m[static_cast<std::size_t>(4 * i + j)].get<double>();
        motion.shift[i] = m[static_cast<std::size_t>(4 * i + 3)].get<double>();
      }
      all.push_back(motion);
    }
  if (info.contains("symmetries_continuous"))
    for (const Json& axis : info["symmetries_continuous"])
      for (int degrees = 2; degrees < 360; degrees += 2) {
        BopPose motion;
        motion.turn = Eigen::AngleAxisd(degrees * pi / 180, vector_of(axis["axis"])).toRotationMatrix();
        motion.shift = vector_of(axis["offset"]) - motion.turn * vector_of(axis["offset"]);
        all.push_back(motion);
      }
  return all;
}

class BopSet : public ::testing::Test {
 protected:
  const fs::path& folder() const { return temporary_.path(); }
  Outcome run(const Arguments& arguments) const { return run_program(folder(), arguments); }
  Json json(const fs::path& file) const { return Json::parse(bytes_of(folder() / file)); }

  void simulate(const Arguments& more = {}) const {
    Arguments arguments{
        "simulate", "--bop",           "-o",      "set",     "--scenes",  "2",     "--objects", "2",
        "--models", "can,jug,tea_box", "--image", "200x150", "--visible", "0.7-1", "--seed",    "5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    ASSERT_EQ(outcome.status, 0) << outcome;
  }
  Outcome localize(const Arguments& more) const {
    Arguments arguments{"localize", "--bop", "set", "--resolution", "0.06", "--w", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  Json annotated_in(int scene_id) const {
    return json(fmt::format("set/test/{:06}/scene_gt.json", scene_id))["0"];
  }

  /// Every annotated object must be among the rows, within a centimetre and five degrees modulo its symmetry.
  void expect_found(const std::string& csv) const {
    const std::vector<Row> rows = rows_in(csv);
    const Json info = json("set/models/models_info.json");
    std::map<int, double> time;
    std::size_t annotated = 0;
    for (int scene_id = 0; scene_id < 2; ++scene_id) {
      const Json truths = annotated_in(scene_id);
      for (const Json& truth : truths) {
        ++annotated;
        double least_angle = std::numeric_limits<double>::infinity(), least_distance = least_angle;
        for (const Row& row : rows) {
          if (row.scene_id != scene_id || row.obj_id != truth["obj_id"]) continue;
          for (const BopPose& s : symmetries_of(info[std::to_string(row.obj_id)])) {
            const Matrix3d turn = matrix_of(truth["cam_R_m2c"]) * s.turn;
            const Vector3d shift = matrix_of(truth["cam_R_m2c"]) * s.shift + vector_of(truth["cam_t_m2c"]);
            const double angle = Eigen::AngleAxisd(turn.transpose() * row.pose.turn).angle();
            if (angle >= least_angle) continue;
            least_angle = angle;
            least_distance = (shift - row.pose.shift).norm();
          }
        }
        EXPECT_LT(least_angle, 5.0 * pi / 180) << "scene " << scene_id << ", object " << truth["obj_id"];
        EXPECT_LT(least_distance, 10.0) << "scene " << scene_id << ", object " << truth["obj_id"];
      }
    }
    EXPECT_EQ(rows.size(), annotated);
    for (const Row& row : rows) {
      EXPECT_EQ(row.im_id, 0);
      EXPECT_GE(row.score, 0.0);
      EXPECT_LE(row.score, 1.0);
      EXPECT_GT(row.time, 0.0);
      EXPECT_EQ(time.emplace(row.scene_id, row.time).first->second, row.time) << "one time an image";
      EXPECT_LT((row.pose.turn * row.pose.turn.transpose() - Matrix3d::Identity()).norm(), 1e-9);
      EXPECT_GT(row.pose.turn.determinant(), 0.0);
    }
  }

 private:
  TemporaryFolder temporary_;
};

/// Too slow for sanitizers.
class BopSetHeavy : public BopSet {};

TEST_F(BopSet, HoldsWhatBopHolds) {
  simulate();
  const Json info = json("set/models/models_info.json");
  ASSERT_EQ(info.size(), 3U);
  EXPECT_TRUE(info["1"].contains("symmetries_continuous"));  // the can
  EXPECT_FALSE(info["2"].contains("symmetries_discrete"));   // the jug
  EXPECT_EQ(info["3"]["symmetries_discrete"].size(), 3U);    // the square box
  EXPECT_NEAR(info["3"]["diameter"].get<double>(),           // whose diameter is its diagonal
              vector_of({info["3"]["size_x"], info["3"]["size_y"], info["3"]["size_z"]}).norm(), 0.01);
  EXPECT_NEAR(info["2"]["min_x"].get<double>(), -0.5 * info["2"]["size_x"].get<double>(), 1e-3)
      << "origin in the middle";
  const Json targets = json("set/test_targets_bop19.json");
  std::size_t listed = 0;
  for (const Json& target : json("set/test_targets_bop19.json"))
    listed += target["inst_count"].get<std::size_t>();
  EXPECT_EQ(listed, 4U);
  for (const std::string scene : {"set/test/000000", "set/test/000001"}) {
    const Json camera = json(scene + "/scene_camera.json")["0"];
    EXPECT_EQ(camera["cam_K"][8], 1);
    const auto depth = read_png16_gray(folder() / scene / "depth/000000.png", 200, 150);
    const Json facts = json(scene + "/scene_gt_info.json")["0"], truth = json(scene + "/scene_gt.json")["0"];
    ASSERT_EQ(facts.size(), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const std::string name = fmt::format("000000_{:06}.png", i);
      const auto mask = read_mask(folder() / scene / "mask" / name, 200, 150),
                 visible = read_mask(folder() / scene / "mask_visib" / name, 200, 150);
      int all = 0, seen = 0, valid = 0, left = 200, top = 150;
      for (int v = 0; v < 150; ++v)
        for (int u = 0; u < 200; ++u) {
          all += mask(u, v);
          seen += visible(u, v);
          valid += mask(u, v) != 0 && depth(u, v) != 0;
          EXPECT_LE(visible(u, v), mask(u, v));
          if (mask(u, v) != 0) {
            left = std::min(left, u);
            top = std::min(top, v);
          }
        }
      EXPECT_EQ(facts[i]["px_count_all"], all);
      EXPECT_EQ(facts[i]["px_count_visib"], seen);
      EXPECT_EQ(facts[i]["px_count_valid"], valid);
      EXPECT_EQ(facts[i]["bbox_obj"][0], left);
      EXPECT_EQ(facts[i]["bbox_obj"][1], top);
      // The model's origin, the middle of its box, is seen at the middle of its silhouette or nearby.
      const Vector3d at = matrix_of(camera["cam_K"]) * vector_of(truth[i]["cam_t_m2c"]);
      EXPECT_NEAR(at.x() / at.z(), left + 0.5 * facts[i]["bbox_obj"][2].get<double>(), 8.0);
      EXPECT_NEAR(at.y() / at.z(), top + 0.5 * facts[i]["bbox_obj"][3].get<double>(), 8.0);
    }
  }
}

TEST_F(BopSetHeavy, IsFoundAgain) {
  simulate();
  const Outcome outcome = localize({"--targets", "test_targets_bop19.json", "-o", "out"});
  ASSERT_EQ(outcome.status, 0) << outcome;
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("4 annotated objects: MSSD"));
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("4 within a tenth of the diameter"));
  expect_found(bytes_of(folder() / "out/perch_set-test.csv"));
  for (const std::string image : {"000000_000000", "000001_000000"})
    for (const char* name : {"result.json", "rendered_depth.png", "picture.png"})
      EXPECT_TRUE(fs::exists(folder() / "out" / image / name)) << image << "/" << name;
  // One image alone: the same rows but for the time.
  ASSERT_EQ(localize({"--scene", "1", "--image", "0", "-q", "-o", "one"}).status, 0);
  const auto all = rows_in(bytes_of(folder() / "out/perch_set-test.csv")),
             one = rows_in(bytes_of(folder() / "one/perch_set-test.csv"));
  ASSERT_EQ(one.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one[i].obj_id, all[i + 2].obj_id);
    EXPECT_EQ(one[i].pose.turn, all[i + 2].pose.turn);
    EXPECT_EQ(one[i].pose.shift, all[i + 2].pose.shift);
  }
  EXPECT_TRUE(fs::exists(folder() / "one/result.json"));
}

TEST_F(BopSetHeavy, IsFoundAgainInOtherFramesOfTheModels) {
  // Each model's frame turned and shifted, so that it is never +z that points up: only rest poses find it.
  simulate();
  Json info = json("set/models/models_info.json");
  std::map<int, BopPose> moved;  // new frame from old
  for (int id = 1; id <= 3; ++id) {
    BopPose& by = moved[id];
    by.turn = Eigen::AngleAxisd(pi / 2, Vector3d::Unit(id % 2)).toRotationMatrix();
    by.shift = Vector3d(10.0 * id, -20.0, 5.0);
    const fs::path file = folder() / fmt::format("set/models/obj_{:06}.ply", id);
    std::string ply = bytes_of(file);
    const std::size_t count = std::stoul(ply.substr(ply.find("element vertex ") + 15)),
                      begin = ply.find("end_header\n") + 11;
    for (std::size_t i = 0; i < count; ++i) {
      float xyz[3];
      std::memcpy(xyz, ply.data() + begin + 12 * i, 12);
      const Vector3d p = by.turn * Vector3d(xyz[0], xyz[1], xyz[2]) + by.shift;
      for (int k = 0; k < 3; ++k) xyz[k] = static_cast<float>(p[k]);
      std::memcpy(ply.data() + begin + 12 * i, xyz, 12);
    }
    write(file, ply);
    Json& entry = info[std::to_string(id)];
    if (entry.contains("symmetries_continuous"))
      for (Json& axis : entry["symmetries_continuous"]) {
        axis["axis"] = rows_of(by.turn * vector_of(axis["axis"]));
        axis["offset"] = rows_of(by.turn * vector_of(axis["offset"]) + by.shift);
      }
    if (entry.contains("symmetries_discrete"))
      for (Json& m : entry["symmetries_discrete"]) {
        Eigen::Isometry3d old, change = Eigen::Isometry3d::Identity();
        for (int i = 0; i < 16; ++i)
          old.matrix()(i / 4, i % 4) = m[static_cast<std::size_t>(i)].get<double>();
        change.linear() = by.turn;
        change.translation() = by.shift;
        m = rows_of((change * old * change.inverse()).matrix());
      }
  }
  write(folder() / "set/models/models_info.json", info.dump());
  for (const std::string scene : {"set/test/000000", "set/test/000001"}) {
    Json truth = json(scene + "/scene_gt.json");
    for (Json& object : truth["0"]) {
      const BopPose& by = moved.at(object["obj_id"]);
      const Matrix3d turn = matrix_of(object["cam_R_m2c"]) * by.turn.transpose();
      object["cam_t_m2c"] = rows_of(vector_of(object["cam_t_m2c"]) - turn * by.shift);
      object["cam_R_m2c"] = rows_of(turn);
    }
    write(folder() / scene / "scene_gt.json", truth.dump());
  }
  const Outcome outcome = localize({"--targets", "test_targets_bop19.json", "-o", "out"});
  ASSERT_EQ(outcome.status, 0) << outcome;
  expect_found(bytes_of(folder() / "out/perch_set-test.csv"));
}

TEST_F(BopSet, BrokenOnesAreRefused) {
  simulate();
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& words) {
    SCOPED_TRACE(::testing::PrintToString(more));
    Arguments arguments{"localize", "-o", "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto before = contents(folder());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.error_lines(), 1) << outcome;
    EXPECT_THAT(outcome.err, ::testing::Not(::testing::HasSubstr("internal error")));
    for (const std::string& word : words) EXPECT_THAT(outcome.err, ::testing::HasSubstr(word));
    EXPECT_EQ(contents(folder()), before) << "files were left behind or changed";
  };
  const Arguments all{"--bop", "set", "--camera-pose", "--targets", "test_targets_bop19.json"};
  refused({}, {"--bop"});
  refused({"--bop", "none", "--scene", "0", "--image", "0"}, {"none: no such folder"});
  refused({"--bop", "set"}, {"--scene and --image, or --targets"});
  refused({"--bop", "set", "--scene", "0"}, {"--scene and --image belong together"});
  refused({"--bop", "set", "--scene", "0", "--image", "1"}, {"scene_camera.json", "has no image 1"});
  refused({"--bop", "set", "--scene", "9", "--image", "0"}, {"000009: no such folder"});
  refused({"--bop", "set", "--scene", "0", "--image", "0", "scene.yaml"}, {"leave out scene files"});
  refused({"scene.yaml", "--masks"}, {"--masks", "--bop"});
  refused({"--bop", "set", "--split", "val", "--scene", "0", "--image", "0"}, {"set/val: no such folder"});
  refused({"--bop", "set", "--targets", "list.json"}, {"list.json: no such file"});
  // The last of the images is broken: nothing is written of the first either.
  const fs::path depth = folder() / "set/test/000001/depth/000000.png";
  const std::string kept = bytes_of(depth);
  write(depth, kept.substr(0, kept.size() / 2));
  refused(all, {"000001/depth/000000.png", "truncated"});
  write(depth, kept);
  const fs::path info = folder() / "set/models/models_info.json";
  Json models = Json::parse(bytes_of(info));
  for (auto& [key, model] : models.items()) model["diameter"] = 0.001 * model["diameter"].get<double>();
  write(info, models.dump());
  refused(all, {"models_info.json", "diameter", "metres taken for millimetres"});
  write(info, "{\"1\": {\"diameter\": ");
  refused(all, {"models_info.json", "is no JSON"});
  write(info, "{}");
  refused(all, {"models_info.json", "has no model"});
}

TEST_F(BopSet, IsRefusedWhereItCannotBe) {
  write(folder() / "set/file", "here before");
  const auto before = contents(folder());
  const auto refused = [&](const Arguments& more, const std::string& word) {
    Arguments arguments{"simulate", "--bop"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome;
    EXPECT_THAT(outcome.err, ::testing::HasSubstr(word));
    EXPECT_EQ(contents(folder()), before);
  };
  refused({"-o", "set"}, "set: is there already");
  refused({"-o", "set/file/below"}, "set/file");
  refused({"-o", "new/one", "--models-only"}, "--models-only");
  refused({"-o", "new/one", "--objects", "5", "--workspace", "0.05x0.05"}, "no scene in");
}

}  // namespace
}  // namespace perch::command_line
