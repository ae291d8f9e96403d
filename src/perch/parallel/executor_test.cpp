#include "perch/parallel/executor.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace perch {
namespace {

class EveryExecutor : public testing::TestWithParam<std::size_t> {};

TEST_P(EveryExecutor, RunsEveryIndexOnce) {
  const auto executor = make_executor(GetParam());
  EXPECT_EQ(executor->workers(), GetParam());
  for (const std::size_t n : {0UL, 1UL, 7UL, 10000UL}) {
    std::vector<std::atomic<int>> runs(n);
    std::atomic<bool> strange_worker{false};
    EXPECT_TRUE(executor->for_each(
        n,
        [&](std::size_t i, std::size_t worker) {
          ++runs[i];
          if (worker >= executor->workers()) strange_worker = true;
        },
        StopCondition()));
    EXPECT_FALSE(strange_worker);
    for (const auto& count : runs) EXPECT_EQ(count, 1);
  }
}

TEST_P(EveryExecutor, WorkersDoNotShareTheirScratch) {
  const auto executor = make_executor(GetParam());
  std::vector<std::atomic<int>> inside(executor->workers());
  std::atomic<bool> shared{false};
  executor->for_each(
      5000,
      [&](std::size_t, std::size_t worker) {
        if (++inside[worker] != 1) shared = true;
        --inside[worker];
      },
      StopCondition());
  EXPECT_FALSE(shared);
}

TEST_P(EveryExecutor, StopsInsideABatch) {
  const auto executor = make_executor(GetParam());
  StopCondition stop;
  std::atomic<int> runs{0};
  EXPECT_FALSE(executor->for_each(
      100000,
      [&](std::size_t, std::size_t) {
        if (++runs == 10) stop.cancel();
      },
      stop));
  EXPECT_LT(runs, 100000);
}

TEST_P(EveryExecutor, PassesAnExceptionOn) {
  const auto executor = make_executor(GetParam());
  EXPECT_THROW(executor->for_each(
                   100,
                   [](std::size_t i, std::size_t) {
                     if (i == 50) throw std::runtime_error("fifty");
                   },
                   StopCondition()),
               std::runtime_error);
}

INSTANTIATE_TEST_SUITE_P(Threads, EveryExecutor, testing::Values(1, 2, 4));

}  // namespace
}  // namespace perch
