// Candidates valued late: those that are valued at once, whatever is valued first.

#include "perch/candidates/fixed_candidates.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "cancelling_executor.hpp"
#include "perch/candidates/candidate_floor.hpp"
#include "perch/core/random.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

using Key = std::tuple<std::size_t, bool, double, double, double>;

Key key_of(std::size_t model, bool absent, const Pose& pose) {
  return {model, absent, pose.x, pose.y, pose.yaw};
}

std::map<Key, CandidateId> numbers_of(const CandidateSet& set) {
  std::map<Key, CandidateId> numbers;
  for (CandidateId id = 0; id < set.size(); ++id)
    numbers[key_of(set[id].model, set[id].absent, set[id].pose)] = id;
  return numbers;
}

bool same(const std::vector<Run>& a, const std::vector<Run>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Run& x, const Run& y) { return x.first == y.first && x.last == y.last; });
}

bool same(const Candidate& a, const Candidate& b) {
  return a.model == b.model && a.pose == b.pose && a.absent == b.absent && a.window == b.window &&
         a.explained_count == b.explained_count && a.points == b.points && a.unexplained == b.unexplained &&
         a.exposed == b.exposed && same(a.explained_runs, b.explained_runs) &&
         same(a.certain_runs, b.certain_runs) && same(a.uncertain_runs, b.uncertain_runs) &&
         same(a.explained_pixels, b.explained_pixels) && a.patch.window == b.patch.window &&
         a.patch.depth == b.patch.depth;
}

bool same(const std::vector<FixedCandidates::Hypothesis>& a,
          const std::vector<FixedCandidates::Hypothesis>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.model == y.model && x.pose == y.pose && x.misfit == y.misfit && x.window == y.window &&
           same(x.near, y.near);
  });
}

std::vector<std::size_t> random_places(std::size_t n, double share, Random& random) {
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i < n; ++i)
    if (random.uniform() < share) which.push_back(i);
  return which;
}

SmallProblem problem_of(std::uint64_t seed) {
  return {seed, seed % 2 == 0, seed % 3 == 0 ? RefineMethod::none : RefineMethod::icp,
          3,    seed % 4 == 0, seed % 5 == 0};
}

TEST(FixedCandidates, ValuedInPortionsAreTheSame) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const SmallProblem small = problem_of(seed);
    FixedCandidates at_once = *small.refined;
    ASSERT_TRUE(at_once.value_all(StopCondition()));
    EXPECT_TRUE(at_once.open().empty());
    const auto expected = numbers_of(at_once.set());
    ASSERT_EQ(expected.size(), at_once.set().size());

    Random random(seed);
    FixedCandidates portions = *small.refined;
    std::size_t absent = 0;
    for (std::size_t kind = 0; kind < small.problem->kinds(); ++kind) absent += small.problem->optional(kind);
    EXPECT_EQ(portions.set().size(), absent);
    while (!portions.open().empty()) {
      const auto which = random_places(portions.open().size(), random.uniform(0.0, 0.6), random);
      std::vector<FixedCandidates::Hypothesis> left;
      for (std::size_t i = 0; i < portions.open().size(); ++i)
        if (!std::binary_search(which.begin(), which.end(), i)) left.push_back(portions.open()[i]);
      const std::size_t before = portions.set().size();
      ASSERT_TRUE(portions.value(which, StopCondition()));
      EXPECT_TRUE(same(portions.open(), left)) << "the others stay, in their order";
      EXPECT_LE(portions.set().size(), before + which.size());
    }
    const auto found = numbers_of(portions.set());
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [key, id] : expected) {
      const auto other = found.find(key);
      ASSERT_NE(other, found.end());
      EXPECT_TRUE(same(at_once.set()[id], portions.set()[other->second]));
    }
    for (std::size_t kind = 0; kind < small.problem->kinds(); ++kind)
      EXPECT_EQ(portions.set().of_kind(kind).size(), at_once.set().of_kind(kind).size());
  }
}

TEST(FixedCandidates, AreTheSameOnAnyNumberOfThreads) {
  for (std::uint64_t seed = 11; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const SmallProblem small = problem_of(seed);
    FixedCandidates one = *small.refined;
    const auto executor = make_executor(4);
    auto makers = make_makers(*small.problem, *executor);
    FixedCandidates many(*small.problem, makers, *executor);
    ASSERT_TRUE(many.refine(StopCondition()));
    EXPECT_TRUE(same(one.open(), many.open()));
    EXPECT_EQ(one.hypotheses(), many.hypotheses());
    EXPECT_EQ(one.count(), many.count());
    Random random(seed);
    const auto which = random_places(one.open().size(), 0.5, random);
    ASSERT_TRUE(one.value(which, StopCondition()) && many.value(which, StopCondition()));
    ASSERT_EQ(one.set().size(), many.set().size());
    for (CandidateId id = 0; id < one.set().size(); ++id)
      EXPECT_TRUE(same(one.set()[id], many.set()[id])) << id;
    EXPECT_TRUE(same(one.open(), many.open()));
  }
}

TEST(FixedCandidates, NothingIsValuedWhereTheStopConditionStrikes) {
  const SmallProblem small = problem_of(21);
  // Refining takes fewer bodies, since each takes several hypotheses, and valuing all takes more.
  StopCondition stop;
  const CancellingExecutor executor(stop, small.refined->hypotheses() / 4);
  auto makers = make_makers(*small.problem, executor);
  FixedCandidates candidates(*small.problem, makers, executor);
  ASSERT_TRUE(candidates.refine(stop));
  const auto open = candidates.open();
  const std::size_t valued = candidates.set().size();
  EXPECT_FALSE(candidates.value_all(stop));
  EXPECT_TRUE(stop());
  EXPECT_LE(executor.after(), 1);
  EXPECT_TRUE(same(candidates.open(), open));
  EXPECT_EQ(candidates.set().size(), valued);
  FixedCandidates nothing(*small.problem, makers, executor);
  EXPECT_FALSE(nothing.refine(stop));
}

// What hypotheses explain at most, by any weights, and the least that a scene with them costs.
TEST(FixedCandidates, OpenOnesAreBoundedByWhatTheyAreWorthValued) {
  std::int64_t counted = 0, useful = 0;
  for (std::uint64_t seed = 31; seed <= 34; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SmallProblem small = problem_of(seed);
    const FixedCandidates& open = *small.refined;
    const auto numbers = numbers_of(small.set);
    const std::size_t kinds = small.problem->kinds(), points = small.problem->observation().size();
    Random random(seed);
    std::vector<std::vector<std::int64_t>> weights(kinds, std::vector<std::int64_t>(points));
    for (auto& of_kind : weights)
      for (std::int64_t& weight : of_kind)
        weight = random.below(3) == 0 ? 0 : static_cast<std::int64_t>(random.below(1U << 20));
    std::vector<int> wanted(kinds, 1);
    wanted[random.below(kinds)] = 0;
    const auto of_each = open.most_explained(weights, wanted),
               of_all = open.most_explained({weights.front()}, std::vector<int>(kinds, 1));

    CandidateMaker& maker = small.makers.front();
    Composite others = small.problem->cost().empty();
    for (std::uint64_t i = 0; i < seed % 3; ++i) {
      const auto id = static_cast<CandidateId>(random.below(small.set.size()));
      small.problem->cost().add(others, maker.patch(small.set[id]), maker.scratch());
    }
    const CandidateFloor floor_of(small.problem->cost(), others);
    const auto still = open.most_explained(
        {weights_outside(others.observed, small.problem->observation().size())}, std::vector<int>(kinds, 1));
    const std::int64_t without = small.problem->cost().counts(others).total();

    for (std::size_t i = 0; i < open.open().size(); ++i) {
      const FixedCandidates::Hypothesis& hypothesis = open.open()[i];
      const std::size_t kind = small.problem->kind_of(hypothesis.model);
      if (!wanted[kind]) {
        EXPECT_EQ(of_each[i], 0);
      }
      const auto number = numbers.find(key_of(hypothesis.model, false, hypothesis.pose));
      if (number == numbers.end()) continue;  // none of it is in view
      const Candidate& candidate = small.set[number->second];
      std::int64_t own = 0, common = 0;
      for (const perch::Run& run : candidate.explained_runs)
        for (std::uint32_t p = run.first; p < run.last; ++p) {
          own += weights[kind][p];
          common += weights.front()[p];
        }
      if (wanted[kind]) {
        EXPECT_GE(of_each[i], own);
      }
      EXPECT_GE(of_all[i], common);

      const std::int64_t floor = floor_of(still[i], hypothesis.window);
      const std::int64_t cost =
          small.problem->cost().counts_with(others, maker.patch(candidate), maker.scratch()).total();
      EXPECT_LE(floor, floor_of(candidate)) << "never above the floor of the same one valued";
      EXPECT_LE(floor_of(candidate), cost);
      ++counted;
      useful += floor > without - candidate.points;
    }
  }
  EXPECT_GT(counted, 100);
  EXPECT_GT(useful, counted / 4) << "better than what the number of its points alone says";
}

}  // namespace
}  // namespace perch
