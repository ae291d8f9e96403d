#include "perch/observation/observation.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "perch/core/error.hpp"
#include "perch/core/random.hpp"
#include "perch/observation/nearest_table.hpp"
#include "perch/observation/packed_runs.hpp"
#include "perch/observation/point_set.hpp"

namespace perch {
namespace {

TEST(Observation, HoldsOnePointAPixel) {
  Camera camera;
  camera.intrinsics = {5, 4, 10, 10, 2, 1.5};
  DepthImage depth(5, 4);
  depth(1, 0) = 1.0F;
  depth(4, 2) = 2.0F;
  depth(0, 3) = std::numeric_limits<float>::infinity();  // no reading either
  const Observation observation(camera, depth, std::nullopt);
  ASSERT_EQ(observation.size(), 2U);
  EXPECT_EQ(observation.points()[1], observation.rays().point(4, 2, 2.0F));
  EXPECT_EQ(observation.column(1), 4);
  EXPECT_EQ(observation.row_begin(2), 1U);
  EXPECT_EQ(observation.row_begin(3), 2U);
  EXPECT_EQ(observation.window(), (Window{1, 0, 5, 3}));
  EXPECT_EQ(observation.nearest(), 1.0F);
  EXPECT_EQ(observation.farthest(), 2.0F);
  EXPECT_EQ(observation.state(0, 0), PixelState::free)
      << "background was removed: no reading means nothing there";
}

TEST(Observation, RefusesAnEmptyOne) {
  Camera camera;
  camera.intrinsics = {2, 2, 10, 10, 1, 1};
  EXPECT_THROW(Observation(camera, DepthImage(2, 2), std::nullopt), InputError);
  EXPECT_THROW(Observation(camera, DepthImage(2, 2, 1.0F), Image<std::uint8_t>(2, 2, 0)), InputError);
}

// The table's answer is as near as the nearest point, up to the cells' size; and there is one within reach.
TEST(NearestTable, IsNearestUpToACell) {
  Random random(5);
  Camera camera;
  camera.intrinsics = {60, 50, 60, 60, 30, 25};
  camera.world_from_camera.linear() =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  camera.world_from_camera.translation() << 0.3, -0.2, 1.0;
  DepthImage depth(60, 50);
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (random.uniform() < 0.3) depth[i] = static_cast<float>(random.uniform(0.5, 0.7));
  const Observation observation(camera, depth, std::nullopt);
  const SerialExecutor serial;
  const ThreadExecutor threads(3);
  constexpr double reach = 0.03, cell = 0.005;
  const NearestTable table(observation, reach, serial), same(observation, reach, threads);
  std::vector<Eigen::Vector3f> world;
  for (const auto& p : observation.points()) world.push_back(camera.world_from_camera.cast<float>() * p);
  int found = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3f near = world[random.below(world.size())];
    const Eigen::Vector3f q = near + Eigen::Vector3f(static_cast<float>(random.uniform(-0.04, 0.04)),
                                                     static_cast<float>(random.uniform(-0.04, 0.04)),
                                                     static_cast<float>(random.uniform(-0.04, 0.04)));
    float least = 1e9F;
    for (const auto& p : world) least = std::min(least, (p - q).norm());
    const Eigen::Vector3f* answer = table.lookup(q);
    const Eigen::Vector3f* other = same.lookup(q);
    ASSERT_EQ(answer == nullptr, other == nullptr);
    if (answer == nullptr) {
      ASSERT_GT(least, reach - 2 * cell);
      continue;
    }
    ++found;
    ASSERT_EQ(*answer, *other);
    ASSERT_LE((*answer - q).norm(), least + 3.0 * std::sqrt(3.0) * cell);
  }
  EXPECT_GT(found, 1000);
}

TEST(PointSet, CountsLikeASetOfNumbers) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const std::size_t n = 1 + random.below(700);
    std::vector<bool> a(n), b(n);
    PointSet set_a(n), set_b(n);
    const std::size_t first = random.below(n), last = first + random.below(n - first + 1);
    for (std::size_t i = first; i < last; ++i)
      if (random.uniform() < 0.5) {
        a[i] = true;
        set_a.insert(i);
      }
    for (std::size_t i = 0; i < n; ++i)
      if (random.uniform() < 0.5) {
        b[i] = true;
        set_b.insert(i);
      }
    std::size_t count = 0, only_a = 0;
    for (std::size_t i = 0; i < n; ++i) {
      count += a[i];
      only_a += a[i] && !b[i];
    }
    EXPECT_EQ(set_b.count_between(first, last),
              static_cast<std::size_t>(std::count(b.begin() + static_cast<std::ptrdiff_t>(first),
                                                  b.begin() + static_cast<std::ptrdiff_t>(last), true)));
    const PointSet trimmed = set_a.trimmed();
    EXPECT_EQ(trimmed.count(), count);
    EXPECT_EQ(trimmed.count_not_in(set_b), only_a);
    set_b.insert_all(trimmed);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(trimmed.contains(i), a[i]);
      ASSERT_EQ(set_b.contains(i), a[i] || b[i]);
    }
    EXPECT_LE(trimmed.bytes(), (last - first + 63) / 64 * 8 + 8);
  }
}

TEST(PointSet, GoesToAnotherProcessAsRuns) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const std::size_t n = 1 + random.below(900);
    PointSet set(n);
    bool inside = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (random.uniform() < 0.02) inside = !inside;
      if (inside || random.uniform() < 0.01) set.insert(i);
    }
    ByteWriter to;
    write_runs(to, set.trimmed().runs());
    ByteReader from(to.bytes());
    const PointSet again(read_runs(from));
    EXPECT_TRUE(from.done());
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(again.contains(i), set.contains(i)) << i;
    // What is cut off is noticed.
    Bytes cut = to.take();
    cut.pop_back();
    ByteReader short_one(cut);
    EXPECT_THROW(read_runs(short_one), std::runtime_error);
  }
}

}  // namespace
}  // namespace perch
