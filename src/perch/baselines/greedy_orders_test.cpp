#include "perch/baselines/greedy_orders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "perch/core/random.hpp"

namespace perch {
namespace {

/// A random problem: misfits ascending, collisions from a symmetric table.
struct RandomPlacing {
  GreedyPlacing placing;
  std::vector<std::size_t> offsets;  // of each model's first pose among all
  std::vector<std::vector<char>> table;

  RandomPlacing(std::uint64_t seed, int objects, double share) {
    Random random(seed);
    const std::size_t models = 1 + random.below(4);
    std::size_t all = 0;
    for (std::size_t model = 0; model < models; ++model) {
      offsets.push_back(all);
      std::vector<std::int64_t>& misfits = placing.misfits.emplace_back(random.below(7));
      for (std::int64_t& misfit : misfits) misfit = static_cast<std::int64_t>(random.below(20));
      std::sort(misfits.begin(), misfits.end());
      all += misfits.size();
    }
    for (int i = 0; i < objects; ++i) placing.objects.push_back(random.below(models));
    table.assign(all, std::vector<char>(all, 0));
    for (std::size_t i = 0; i < all; ++i)
      for (std::size_t j = 0; j < i; ++j) table[i][j] = table[j][i] = random.uniform() < share;
    placing.collide = [this](std::size_t a, std::size_t i, std::size_t b, std::size_t j) {
      return table[offsets[a] + i][offsets[b] + j] != 0;
    };
  }
  RandomPlacing(const RandomPlacing&) = delete;

  bool collide(std::size_t a, std::size_t i, std::size_t b, std::size_t j) const {
    return (a == b && i == j) || placing.collide(a, i, b, j);
  }
};

struct Worth {
  int left_out = 0;
  std::int64_t misfit = 0;
};

using Poses = std::vector<std::optional<std::size_t>>;

/// Objects placed one by one in the order given, nothing remembered.
Poses place(const RandomPlacing& random, const std::vector<std::size_t>& order) {
  const GreedyPlacing& placing = random.placing;
  Poses poses(placing.objects.size());
  for (const std::size_t object : order) {
    const std::size_t model = placing.objects[object];
    for (std::size_t pose = 0; pose < placing.misfits[model].size() && !poses[object]; ++pose) {
      bool free = true;
      for (std::size_t other = 0; other < poses.size(); ++other)
        free &= !poses[other] || !random.collide(model, pose, placing.objects[other], *poses[other]);
      if (free) poses[object] = pose;
    }
  }
  return poses;
}

Worth worth(const GreedyPlacing& placing, const Poses& poses) {
  Worth sum;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    sum.left_out += !poses[i];
    if (poses[i]) sum.misfit += placing.misfits[placing.objects[i]][*poses[i]];
  }
  return sum;
}

TEST(GreedyOrders, IsTheBestOfAllOrders) {
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    const RandomPlacing random(seed, 1 + static_cast<int>(seed % 6), 0.15 * static_cast<double>(seed % 5));
    std::vector<std::size_t> order(random.placing.objects.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::vector<Poses> tried;
    do tried.push_back(place(random, order));
    while (std::next_permutation(order.begin(), order.end()));
    Worth best = worth(random.placing, tried.front());
    for (const Poses& poses : tried) {
      const Worth other = worth(random.placing, poses);
      if (other.left_out < best.left_out || (other.left_out == best.left_out && other.misfit < best.misfit))
        best = other;
    }

    const BestOrder found = best_order(random.placing, StopCondition());
    EXPECT_TRUE(found.complete);
    ASSERT_EQ(found.poses.size(), random.placing.objects.size());
    const Worth of_found = worth(random.placing, found.poses);
    EXPECT_EQ(of_found.left_out, best.left_out);
    EXPECT_EQ(of_found.misfit, best.misfit);
    // It is what some order makes, but for which copy of a model stands where.
    const auto by_model = [&](const Poses& poses) {
      std::vector<std::pair<std::size_t, std::optional<std::size_t>>> all;
      for (std::size_t i = 0; i < poses.size(); ++i) all.emplace_back(random.placing.objects[i], poses[i]);
      std::sort(all.begin(), all.end());
      return all;
    };
    EXPECT_TRUE(std::any_of(tried.begin(), tried.end(),
                            [&](const Poses& poses) { return by_model(poses) == by_model(found.poses); }));
  }
}

TEST(GreedyOrders, ManyObjectsThatAreApartAreOneOrder) {
  GreedyPlacing placing;
  for (std::size_t model = 0; model < 20; ++model) {
    placing.misfits.push_back({5, 7});
    placing.objects.push_back(model);
  }
  placing.collide = [](std::size_t, std::size_t, std::size_t, std::size_t) { return false; };
  const BestOrder found = best_order(placing, StopCondition());
  EXPECT_TRUE(found.complete);
  EXPECT_EQ(found.poses, Poses(20, 0));
}

TEST(GreedyOrders, FollowsOneOrderWhateverTheClock) {
  GreedyPlacing placing{{{5, 7}, {6}}, {0, 1}, [](auto...) { return false; }};
  StopCondition stop;
  stop.cancel();
  const BestOrder found = best_order(placing, stop);
  EXPECT_FALSE(found.complete);
  EXPECT_EQ(found.poses, (Poses{0, 0}));
}

}  // namespace
}  // namespace perch
