// Several samples at a time against one at a time in double, and on every instruction set of this processor.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "perch/core/instruction_set.hpp"
#include "perch/refine/icp_test_support.hpp"

namespace perch {
namespace {

class IcpKernelTest : public testing::Test {
 protected:
  void TearDown() override { use_instruction_set(InstructionSet::x86_64_v4); }
};

/// Some samples of a body near where one like it was observed.
struct Problem {
  SurfaceSamples samples;
  Pose pose;
  bool fix_yaw = false;
  double reach = 0.0;
  RefineSettings settings;
};

/// \param samples of a body that stands at the pose.
Problem random_problem(Random& random, const SurfaceSamples& samples, const Pose& pose) {
  Problem problem{{}, pose, random.below(4) == 0, random.uniform(0.01, 0.03), {}};
  const std::size_t count = 1 + random.below(70);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t chosen = random.below(samples.size());
    problem.samples.push_back(samples.point(chosen), samples.normal(chosen));
  }
  problem.settings.iterations = 1 + static_cast<int>(random.below(15));
  problem.settings.robust_scale = random.uniform(0.001, 0.01);
  problem.settings.least_matched = random.uniform(0.0, 0.5);
  return problem;
}

/// Poses beside where a wedge was observed, behind a can that hides some of it, with their problems.
struct ProblemSource {
  RefineBench bench;
  ObjectModel body = object(wedge());
  SurfaceViews views = bench.views(body);
  DepthPatch seen, front = bench.render(round_can(), {0.06, -0.08, 0.0});
  Pose truth;
  Observation observation;
  NearestTable table;

  explicit ProblemSource(Random& random)
      : truth{random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.1), random.uniform(-3, 3)},
        observation(bench.observe({&(seen = bench.render(wedge(), truth)), &front})),
        table(observation, 0.03, bench.executor) {}

  Problem next(Random& random) const {
    const Pose pose{truth.x + random.uniform(-0.03, 0.03), truth.y + random.uniform(-0.03, 0.03),
                    truth.yaw + random.uniform(-0.4, 0.4)};
    return random_problem(random, bench.samples(views, body, pose, observation), pose);
  }
};

/// The point of I nearest to a sample; that of the table, whose cells are told apart in float. \param sure is
/// cleared where rounding could choose another cell.
const Eigen::Vector3f* nearest(const NearestTable& table, const Eigen::Vector3d& p, bool& sure) {
  const NearestTable::Cells cells = table.cells();
  for (const double place : {(p.x() - cells.origin_x) / cells.cell, (p.y() - cells.origin_y) / cells.cell})
    sure = sure && std::abs(place - std::round(place)) > 5e-5;
  return table.lookup(p.cast<float>());
}

/// As align() says, one sample at a time. Empty where its course hangs on rounding.
std::optional<Alignment> reference_align(const Problem& problem, const NearestTable& table) {
  const SurfaceSamples& samples = problem.samples;
  const Pose& pose = problem.pose;
  bool sure = true;
  double arm = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i)
    arm = std::max(arm, std::hypot(static_cast<double>(samples.x[i]) - pose.x,
                                   static_cast<double>(samples.y[i]) - pose.y));
  Alignment found{pose};
  Pose& moved = found.pose;
  for (int iteration = 0; iteration < problem.settings.iterations; ++iteration) {
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(moved.yaw - pose.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double weights = 0.0;
    int matched = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector3d from_axis =
          turn * (samples.point(i).cast<double>() - Eigen::Vector3d(pose.x, pose.y, 0.0));
      const Eigen::Vector3d p = from_axis + Eigen::Vector3d(moved.x, moved.y, 0.0);
      const Eigen::Vector3f* q = nearest(table, p, sure);
      if (q == nullptr) continue;
      const Eigen::Vector3d apart = p - q->cast<double>();
      sure = sure && std::abs(apart.norm() - problem.reach) > 1e-6;
      if (apart.norm() > problem.reach) continue;
      ++matched;
      const Eigen::Vector3d normal = turn * samples.normal(i).cast<double>();
      const double e = normal.dot(apart), weight = 1.0 / (1.0 + std::abs(e) / problem.settings.robust_scale);
      const double turning = Eigen::Vector3d::UnitZ().cross(from_axis).dot(normal) / arm;
      const Eigen::Vector3d jacobian(normal.x(), normal.y(), problem.fix_yaw ? 0.0 : turning);
      normal_matrix += weight * jacobian * jacobian.transpose();
      gradient += weight * e * jacobian;
      weights += weight;
    }
    found.misfit = 1.0 - weights / static_cast<double>(samples.size());
    if (matched == 0 ||
        (iteration == 0 && matched < problem.settings.least_matched * static_cast<double>(samples.size())))
      break;
    normal_matrix += 0.01 * weights * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = -normal_matrix.ldlt().solve(gradient);
    moved.x += step.x();
    moved.y += step.y();
    moved.yaw += problem.fix_yaw ? 0.0 : step.z() / arm;
    sure = sure && std::abs(step.norm() - 2e-4) > 1e-7;
    if (step.norm() < 2e-4) break;
  }
  return sure ? std::optional(found) : std::nullopt;
}

TEST_F(IcpKernelTest, EqualsOneAtATime) {
  int compared = 0, moved = 0, stayed = 0, odd = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    const ProblemSource source(random);
    for (int trial = 0; trial < 60; ++trial) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
      const Problem problem = source.next(random);
      const std::optional<Alignment> expected = reference_align(problem, source.table);
      if (!expected) continue;
      ++compared;
      ++(expected->pose == problem.pose ? stayed : moved);
      odd += problem.samples.size() % lane_count != 0;
      const auto [found, misfit] = align(problem.samples, problem.pose, problem.fix_yaw, source.table,
                                         problem.reach, problem.settings);
      EXPECT_NEAR(misfit, expected->misfit, 1e-4);
      EXPECT_NEAR(found.x, expected->pose.x, 1e-5);
      EXPECT_NEAR(found.y, expected->pose.y, 1e-5);
      EXPECT_NEAR(found.yaw, expected->pose.yaw, 1e-4);
      EXPECT_EQ(found == problem.pose, expected->pose == problem.pose);
      if (problem.fix_yaw) {
        EXPECT_EQ(found.yaw, problem.pose.yaw);
      }
    }
  }
  EXPECT_GT(compared, 500);
  EXPECT_GT(moved, 300);
  EXPECT_GT(stayed, 20);
  EXPECT_GT(odd, 300);
}

TEST_F(IcpKernelTest, IsTheSameOnAllInstructionSets) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const ProblemSource source(random);
    for (int trial = 0; trial < 60; ++trial) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", trial " << trial);
      const Problem problem = source.next(random);
      const auto aligned = [&](InstructionSet set) {
        use_instruction_set(set);
        return align(problem.samples, problem.pose, problem.fix_yaw, source.table, problem.reach,
                     problem.settings);
      };
      const Alignment expected = aligned(InstructionSet::baseline);
      EXPECT_EQ(aligned(InstructionSet::x86_64_v3), expected);
      EXPECT_EQ(aligned(InstructionSet::x86_64_v4), expected);
    }
  }
}

}  // namespace
}  // namespace perch
