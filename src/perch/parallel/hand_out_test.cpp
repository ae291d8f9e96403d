#include "perch/parallel/hand_out.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace perch {
namespace {

/// Only its shape matters here.
class Shape final : public Batch {
 public:
  Shape(std::size_t size, bool fills_process) : size_(size), fills_process_(fills_process) {}
  std::size_t size() const override { return size_; }
  std::string topic() const override { return "shape"; }
  void work(std::size_t, std::size_t) override {}
  void write_question(std::size_t, ByteWriter&) const override {}
  void read_answer(std::size_t, ByteReader&) override {}
  bool fills_process() const override { return fills_process_; }

 private:
  std::size_t size_;
  bool fills_process_;
};

TEST(HandOut, GivesEachItemOnceWhoeverAsksWhen) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto up_to = [&](std::size_t n) {
      return std::uniform_int_distribution<std::size_t>(0, n)(random);
    };
    std::vector<std::size_t> workers(1 + up_to(6));
    for (std::size_t& w : workers) w = 1 + up_to(7);
    const Shape shape(up_to(2000), up_to(4) == 0);
    Pace pace(workers.size());
    HandOut hand_out(shape, workers);
    std::vector<int> given(shape.size(), 0);
    // Some processes may never ask.
    const std::size_t asking = 1 + up_to(workers.size() - 1);
    while (hand_out.left() > 0) {
      const std::size_t process = up_to(asking - 1);
      const auto items = hand_out.take(process, pace);
      ASSERT_FALSE(items.empty());
      for (const std::size_t item : items) ++given[item];
      pace.took(process, items.size(), 1e-6 * static_cast<double>(1 + up_to(100000)));
    }
    EXPECT_TRUE(hand_out.take(0, pace).empty());
    EXPECT_TRUE(std::all_of(given.begin(), given.end(), [](int times) { return times == 1; }));
  }
}

TEST(HandOut, GivesTheSameItemsToTheSameProcessWhileAllAreAsFast) {
  const Shape shape(1000, false);
  const std::vector<std::size_t> workers{2, 2, 4};
  std::vector<std::size_t> owner(1000);
  for (int round = 0; round < 2; ++round) {
    Pace pace(3);
    for (std::size_t p = 0; p < 3; ++p) pace.took(p, 100 * workers[p], 1.0);
    HandOut hand_out(shape, workers);
    for (bool left = true; left;) {
      left = false;
      for (std::size_t p = 0; p < 3; ++p) {
        const auto items = hand_out.take(p, pace);
        for (const std::size_t item : items) {
          if (round == 0) owner[item] = p;
          EXPECT_EQ(owner[item], p);
        }
        left |= !items.empty();
      }
    }
  }
  EXPECT_EQ(std::count(owner.begin(), owner.end(), 2U), 500);
}

TEST(HandOut, TakesLargerPortionsWhereItemsAreCheapAndSmallOnesAtTheEnd) {
  const Shape shape(100000, false);
  Pace pace(2);
  pace.took(0, 1000, 0.01);
  pace.took(1, 10, 0.01);
  HandOut hand_out(shape, {1, 1});
  EXPECT_EQ(hand_out.take(0, pace).size(), 1000U);
  EXPECT_EQ(hand_out.take(1, pace).size(), 10U);
  while (hand_out.left() > 1000) hand_out.take(0, pace);
  EXPECT_LE(hand_out.take(0, pace).size(), 250U);
}

// A list schedule whose last portions are small: nobody waits much longer than a portion.
TEST(HandOut, KeepsUnequalProcessesBusyToTheEnd) {
  const std::vector<double> seconds_an_item{0.001, 0.004, 0.0005, 0.002};
  const Shape shape(20000, false);
  Pace pace(4);
  HandOut hand_out(shape, {1, 1, 1, 1});
  std::vector<double> ready(4, 0.0);
  for (;;) {
    const auto process =
        static_cast<std::size_t>(std::min_element(ready.begin(), ready.end()) - ready.begin());
    const auto items = hand_out.take(process, pace);
    if (items.empty()) break;
    const double taken = static_cast<double>(items.size()) * seconds_an_item[process];
    pace.took(process, items.size(), taken);
    ready[process] += taken;
  }
  double items_a_second = 0.0;
  for (const double s : seconds_an_item) items_a_second += 1.0 / s;
  const double best = 20000.0 / items_a_second;
  EXPECT_LE(*std::max_element(ready.begin(), ready.end()), best + 0.02);
}

}  // namespace
}  // namespace perch
