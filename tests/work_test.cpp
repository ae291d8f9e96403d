// How much work a scene takes, counted: a guard against doing more of it unnoticed, however busy the machine.

#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <string>

#include "perch/core/instruction_set.hpp"
#include "perch/localize/localize.hpp"
#include "perch/sim/scene_generator.hpp"

namespace perch {
namespace {

/// A random tabletop of household models under default settings, and the most that localizing it may take:
/// about a tenth more than it did when the number was set.
struct Budget {
  int objects;
  std::uint64_t seed;
  double w;
  std::int64_t hypotheses, renderings, alignments, pixels;
};
constexpr Budget budgets[] = {
    {3, 1, 3.0, 2'380, 610, 3'750, 4'600'000},
    {3, 1, 1.0, 2'380, 750, 3'770, 5'540'000},
    {5, 1, 3.0, 6'180, 1'700, 10'830, 11'600'000},
};
// Of the search alone: bounds rule most hypotheses out without a rendering, and each is aligned in two rounds
// at most. The polish and the confidences try poses of each object of the answer, however many hypotheses
// there are.
constexpr double renderings_per_hypothesis = 0.122;
constexpr double alignments_per_hypothesis = 2.0;
constexpr std::int64_t alignments_after_search = 97;

void PrintTo(const Budget& budget, std::ostream* out) {
  *out << budget.objects << " objects, seed " << budget.seed << ", w = " << budget.w;
}

Stats localized(const Budget& budget, std::size_t threads, bool search_alone = false) {
  TabletopOptions options;
  options.min_objects = options.max_objects = budget.objects;
  Settings settings;
  settings.w = budget.w;
  if (search_alone) settings.polish.rounds = settings.ambiguity.trials = 0;
  const Result result = localize(random_tabletop(budget.seed, options).scene, settings,
                                 *make_executor(threads), StopCondition());
  EXPECT_EQ(result.status, Status::solved) << result.reason;
  return result.stats;
}

class WorkTest : public testing::TestWithParam<Budget> {};

TEST_P(WorkTest, StaysWithinItsBounds) {
  const auto expect_at_most = [](const char* counter, auto value, auto most) {
    EXPECT_LE(value, most) << counter << ": " << value << ", but at most " << most
                           << " are allowed; raise this bound (top of work_test.cpp) on purpose only";
  };
  const Budget& most = GetParam();
  const Stats stats = localized(most, 1);
  expect_at_most("hypotheses", stats.rendered, most.hypotheses);
  expect_at_most("renderings", stats.work.renderings, most.renderings);
  expect_at_most("alignments", stats.work.alignments, most.alignments);
  expect_at_most("pixels", stats.work.pixels, most.pixels);

  const Stats search = localized(most, 1, true);
  const auto per_hypothesis = [&](std::int64_t count) {
    return static_cast<double>(count) / static_cast<double>(search.rendered);
  };
  expect_at_most("renderings of the search per hypothesis", per_hypothesis(search.work.renderings),
                 renderings_per_hypothesis);
  expect_at_most("alignments of the search per hypothesis", per_hypothesis(search.work.alignments),
                 alignments_per_hypothesis);
  expect_at_most("alignments after the search", stats.work.alignments - search.work.alignments,
                 alignments_after_search);
}

TEST(Work, IsTheSameForEveryExecutorAndInstructionSet) {
  const Budget& budget = budgets[1];
  const Stats serial = localized(budget, 1), threads = localized(budget, 4);
  use_instruction_set(InstructionSet::baseline);
  const Stats baseline = localized(budget, 4);
  use_instruction_set(InstructionSet::x86_64_v4);
  for (const Stats* other : {&threads, &baseline}) {
    SCOPED_TRACE(other == &threads ? "4 threads" : "4 threads, baseline instruction set");
    EXPECT_EQ(other->rendered, serial.rendered);
    EXPECT_EQ(other->work.renderings, serial.work.renderings);
    EXPECT_EQ(other->work.alignments, serial.work.alignments);
    EXPECT_EQ(other->work.pixels, serial.work.pixels);
  }
}

INSTANTIATE_TEST_SUITE_P(Tabletops, WorkTest, testing::ValuesIn(budgets), [](const auto& run) {
  const Budget& budget = run.param;
  return std::to_string(budget.objects) + "Objects" + (budget.w == 1.0 ? "Optimal" : "");
});

}  // namespace
}  // namespace perch
