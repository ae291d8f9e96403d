// The Lagrangian bound with weights by blocks of pixels: against every scene's J, and against its own formula
// summed pixel by pixel.

#include "perch/candidates/coarse_dual.hpp"

#include <gtest/gtest.h>

#include "perch/core/instruction_set.hpp"
#include "perch/core/random.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

using Weight = Lagrangian::Weight;

/// Some candidates of each kind in random order, few of which explain nothing.
CandidateSet some_of(const LocalizationProblem& problem, const CandidateSet& set, std::size_t most,
                     Random& random) {
  std::vector<CandidateId> chosen;
  for (std::size_t kind = 0; kind < problem.kinds(); ++kind) {
    std::vector<CandidateId> ids = set.of_kind(kind);
    if (ids.empty()) continue;  // of a model that is not looked for
    std::stable_sort(ids.begin(), ids.end(), [&](CandidateId a, CandidateId b) {
      return set[a].explained_count > set[b].explained_count;
    });
    for (std::size_t i = 0; i < most; ++i)
      chosen.push_back(ids[random.below(i % 3 == 0 ? ids.size() : std::min(ids.size(), 2 * most))]);
    for (const CandidateId id : ids)
      if (set[id].absent) chosen.push_back(id);
  }
  for (std::size_t i = chosen.size(); i > 1; --i) std::swap(chosen[i - 1], chosen[random.below(i)]);
  CandidateSet some(problem);
  for (const CandidateId id : chosen) some.add(set[id]);
  return some;
}

/// Two to four objects, some of them copies, some optional; with pixels that are unknown, counted or not.
std::unique_ptr<SmallProblem> problem_of_few(std::uint64_t seed) {
  Random random(seed);
  SimulatedScene simulated = small_tabletop(seed, random.below(2) == 0, 2 + static_cast<int>(random.below(3)),
                                            random.below(3) == 0, random.below(3) == 0);
  if (seed % 3 == 0) simulated = with_rest_poses(simulated, seed);
  if (random.below(2) == 0) add_mask(simulated.scene, random);
  Settings settings = small_settings(random.below(3) == 0 ? RefineMethod::none : RefineMethod::icp);
  if (random.below(2) == 0) settings.candidates.cost.missing_depth = MissingDepth::ignore;
  add_clutter(simulated.scene, settings, random);
  auto small = std::make_unique<SmallProblem>(std::move(simulated), settings);
  small->set = some_of(*small->problem, small->set, 6, random);
  return small;
}

/// The formula as it is written, from the weights of points and pixels.
class PlainWorth {
 public:
  PlainWorth(const LocalizationProblem& problem, const CoarseDual& dual)
      : problem_(problem), dual_(dual), mu_(dual.point_weights()) {}

  Weight operator()(const Candidate& c) const {
    Weight sum = explained(c);
    for_each(c.certain_runs,
             [&](std::uint32_t x) { sum -= dual_.pixel_weight(problem_.kind_of(c.model), x).certain; });
    for_each(c.uncertain_runs,
             [&](std::uint32_t x) { sum -= dual_.pixel_weight(problem_.kind_of(c.model), x).uncertain; });
    for_each(c.explained_pixels, [&](std::uint32_t x) {
      for (std::size_t n = 0; n < problem_.kinds(); ++n)
        sum += (problem_.copies()[n] - (n == problem_.kind_of(c.model) ? 1 : 0)) *
               dual_.pixel_weight(n, x).uncertain;
    });
    return sum;
  }
  Weight explained(const Candidate& c) const {
    Weight sum = 0;
    for_each(c.explained_runs, [&](std::uint32_t p) { sum += mu_[p]; });
    return sum;
  }

 private:
  template <typename Visit>
  static void for_each(const std::vector<Run>& runs, Visit visit) {
    for (const Run& run : runs)
      for (std::uint32_t i = run.first; i < run.last; ++i) visit(i);
  }

  const LocalizationProblem& problem_;
  const CoarseDual& dual_;
  std::vector<Weight> mu_;
};

void expect_feasible(const LocalizationProblem& problem, const CoarseDual& dual) {
  Weight sum = 0;
  for (const Weight mu : dual.point_weights()) {
    ASSERT_GE(mu, 0);
    ASSERT_LE(mu, Lagrangian::one);
    sum += mu;
  }
  EXPECT_EQ(dual.constant(), sum);
  const Intrinsics& k = problem.observation().intrinsics();
  for (std::uint32_t x = 0; x < static_cast<std::uint32_t>(k.width * k.height); ++x) {
    Weight total = 0;
    for (std::size_t kind = 0; kind < problem.kinds(); ++kind) {
      const Lagrangian::PixelWeight weight = dual.pixel_weight(kind, x);
      ASSERT_GE(weight.certain, 0);
      ASSERT_GE(weight.uncertain, 0);
      total += problem.copies()[kind] * (weight.certain + weight.uncertain);
    }
    ASSERT_LE(total, Lagrangian::one) << "pixel " << x;
  }
}

/// Relief of a window is at least that of its pixels.
void expect_relief(const LocalizationProblem& problem, const CoarseDual& dual, Random& random) {
  const Intrinsics& k = problem.observation().intrinsics();
  for (std::size_t kind = 0; kind < problem.kinds(); ++kind) {
    if (problem.copies()[kind] == 0) continue;
    const int u0 = static_cast<int>(random.below(60)), v0 = static_cast<int>(random.below(45));
    const Window window{u0, v0, u0 + 1 + static_cast<int>(random.below(20)),
                        v0 + 1 + static_cast<int>(random.below(15))};
    Weight sum = 0;
    for (int v = window.v0; v < window.v1; ++v)
      for (int u = window.u0; u < window.u1; ++u)
        for (std::size_t n = 0; n < problem.kinds(); ++n)
          sum += (problem.copies()[n] - (n == kind ? 1 : 0)) *
                 dual.pixel_weight(n, static_cast<std::uint32_t>(v * k.width + u)).uncertain;
    EXPECT_GE(dual.relief(kind, window), sum);
  }
}

Weight bound_of(const LocalizationProblem& problem, const CoarseDual& dual) {
  Weight bound = dual.constant();
  for (std::size_t kind = 0; kind < problem.kinds(); ++kind)
    bound -= problem.copies()[kind] * dual.largest()[kind];
  return bound;
}

/// What holds at any weights. \param valued those that the dual has taken in. \param scenes of any
/// candidates.
void expect_bound(const SmallProblem& small, const CoarseDual& dual, const CandidateSet& valued,
                  const std::vector<CandidateScene>& scenes) {
  const LocalizationProblem& problem = *small.problem;
  const PlainWorth worth(problem, dual);
  std::vector<std::optional<Weight>> largest(problem.kinds());
  for (CandidateId id = 0; id < valued.size(); ++id) {
    const std::optional<Weight>& most = largest[valued.kind(id)];
    if (const Weight own = worth(valued[id]); !most || own > *most) largest[valued.kind(id)] = own;
  }
  for (std::size_t kind = 0; kind < largest.size(); ++kind) {
    if (problem.copies()[kind] > 0) {
      EXPECT_EQ(dual.largest()[kind], largest[kind]);
    }
  }
  std::vector<Weight> worths;
  for (CandidateId id = 0; id < small.set.size(); ++id) {
    const Candidate& c = small.set[id];
    worths.push_back(worth(c));
    const Weight explained = worth.explained(c);
    EXPECT_LE(worths.back(), explained + dual.relief(problem.kind_of(c.model), c.window));
    if (c.absent) {
      EXPECT_EQ(worths.back(), 0);
    } else {
      EXPECT_LE(worths.back(),
                explained + dual.relief(problem.kind_of(c.model), problem.window(c.model, c.pose)));
    }
  }
  for (const CandidateScene& scene : scenes) {
    Weight sum = dual.constant();
    for (const CandidateId id : scene.candidates) sum -= worths[id];
    ASSERT_LE(sum, scene.cost * Lagrangian::one);
  }
}

/// Colliding objects are no matter here, and objects that hide one another are wanted.
std::vector<CandidateScene> all_scenes(SmallProblem& small) {
  std::vector<CandidateScene> scenes;
  small.for_each_scene([&](const std::vector<CandidateId>& placed) {
    scenes.push_back({placed, small.flat_cost(placed)});
  });
  return scenes;
}

std::int64_t least_cost(const std::vector<CandidateScene>& scenes) {
  std::int64_t least = none;
  for (const CandidateScene& scene : scenes) least = std::min(least, scene.cost);
  return least;
}

TEST(CoarseDualHeavy, IsNeverAboveTheCostOfAScene) {
  double proven = 0.0, best = 0.0, before = 0.0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto small = problem_of_few(seed);
    const auto scenes = all_scenes(*small);
    const std::int64_t least = least_cost(scenes);
    Random random(seed);
    CoarseDual dual(*small->problem);
    dual.add(small->set, small->executor);
    std::optional<Weight> last;
    for (const int iterations : {0, 1, 2, 4, 8, 40, 0}) {
      const std::int64_t aim =
          random.below(3) == 0 ? std::int64_t{1} << 40 : least + static_cast<std::int64_t>(random.below(200));
      dual.ascend(iterations, aim, 1e18, small->executor, StopCondition());
      expect_feasible(*small->problem, dual);
      for (int i = 0; i < 5; ++i) expect_relief(*small->problem, dual, random);
      expect_bound(*small, dual, small->set, scenes);
      if (testing::Test::HasFatalFailure()) return;
      const Weight bound = bound_of(*small->problem, dual);
      EXPECT_LE(bound, least * Lagrangian::one);
      if (last) {
        EXPECT_GE(bound, *last) << "the best weights are kept";
      } else {
        before += static_cast<double>(bound) / Lagrangian::one;
      }
      last = bound;
    }
    proven += static_cast<double>(*last) / Lagrangian::one;
    best += static_cast<double>(least);
  }
  testing::Test::RecordProperty("proven of best", std::to_string(proven / best));
  EXPECT_GT(proven, 0.6 * best);
  EXPECT_GT(proven, 1.1 * before);
}

// As columns are generated: what comes later is worth what the formula says at the weights there are.
TEST(CoarseDualHeavy, TakesInCandidatesLater) {
  for (std::uint64_t seed = 101; seed <= 105; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto small = problem_of_few(seed);
    const auto scenes = all_scenes(*small);
    Random random(seed);
    CandidateSet valued(*small->problem);
    for (std::size_t kind = 0; kind < small->problem->kinds(); ++kind)
      if (small->problem->copies()[kind] > 0) valued.add(small->set[small->set.of_kind(kind).front()]);
    CoarseDual dual(*small->problem);
    CandidateId next = 0;
    while (true) {
      dual.add(valued, small->executor);
      dual.ascend(static_cast<int>(random.below(12)), least_cost(scenes) + 1, 1e18, small->executor,
                  StopCondition());
      expect_feasible(*small->problem, dual);
      expect_bound(*small, dual, valued, scenes);
      if (testing::Test::HasFatalFailure() || next == small->set.size()) break;
      for (std::uint64_t i = 1 + random.below(4); i > 0 && next < small->set.size(); --i)
        valued.add(small->set[next++]);
    }
  }
}

// With one candidate of each kind, each is the best of its kind.
TEST(CoarseDual, EachCandidateIsWorthWhatTheFormulaSays) {
  int checked = 0;
  for (std::uint64_t seed = 201; seed <= 203; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto small = problem_of_few(seed);
    for (std::size_t round = 0; round < 8; ++round) {
      CandidateSet one_each(*small->problem);
      for (std::size_t kind = 0; kind < small->problem->kinds(); ++kind)
        if (const auto& ids = small->set.of_kind(kind); !ids.empty())
          one_each.add(small->set[ids[round % ids.size()]]);
      CoarseDual dual(*small->problem);
      dual.add(one_each, small->executor);
      dual.ascend(static_cast<int>(round), 50, 1e18, small->executor, StopCondition());
      const PlainWorth worth(*small->problem, dual);
      for (CandidateId id = 0; id < one_each.size(); ++id, ++checked)
        if (small->problem->copies()[one_each.kind(id)] > 0) {
          EXPECT_EQ(dual.largest()[one_each.kind(id)], worth(one_each[id]));
        }
    }
  }
  EXPECT_GT(checked, 30);
}

TEST(CoarseDual, IsTheSameOnEveryInstructionSetAndNumberOfThreads) {
  for (std::uint64_t seed = 301; seed <= 302; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto small = problem_of_few(seed);
    std::optional<std::vector<Weight>> first;
    for (const InstructionSet set :
         {InstructionSet::baseline, InstructionSet::x86_64_v3, InstructionSet::x86_64_v4})
      for (const std::size_t threads : {1, 4}) {
        use_instruction_set(set);
        const auto executor = make_executor(threads);
        CoarseDual dual(*small->problem);
        dual.add(small->set, *executor);
        dual.ascend(25, 100, 1e18, *executor, StopCondition());
        std::vector<Weight> all = dual.point_weights();
        all.push_back(dual.constant());
        all.insert(all.end(), dual.largest().begin(), dual.largest().end());
        for (std::size_t kind = 0; kind < small->problem->models().size(); ++kind)
          for (std::uint32_t x = 0; x < 80 * 60; ++x) {
            all.push_back(dual.pixel_weight(kind, x).certain);
            all.push_back(dual.pixel_weight(kind, x).uncertain);
          }
        if (!first) first = all;
        EXPECT_EQ(all, *first);
      }
    use_instruction_set(InstructionSet::x86_64_v4);
  }
}

}  // namespace
}  // namespace perch
