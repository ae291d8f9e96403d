// Whole localizations in several processes, against one.

#include <gtest/gtest.h>

#include <string>

#include "local_team.hpp"
#include "perch/io/result_json.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/services.hpp"
#include "small_problem.hpp"

namespace perch {
namespace {

/// result.json without what may differ.
std::string answer(Result result) {
  result.stats.seconds = {};
  result.stats.threads = result.stats.ranks = 1;
  return to_json(result);
}

// Pauses on the way change who works on what, but not what comes out.
TEST(SharedLocalization, AnswersAsOneProcessDoesToEverySetting) {
  std::uint64_t elsewhere = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    SimulatedScene simulated = small_tabletop(seed, true, 3, seed % 4 == 0, seed % 3 == 0);
    if (seed % 5 == 0) simulated = with_rest_poses(simulated, seed);
    Settings settings;
    settings.candidates.grid.resolution = 0.06;
    settings.w = seed % 2 == 0 ? 1.0 : 3.0;
    settings.max_expansions = 15;
    if (seed % 3 == 1) settings.method = SearchMethod::focal_mha;
    if (seed % 3 == 2) settings.mode = CandidateMode::context;
    if (seed % 6 == 5) settings.max_expansions = 3;
    const Result one = localize(simulated.scene, settings, SerialExecutor(), StopCondition());
    const Link link{seed % 2 == 0 ? 0.0 : 0.0005, seed % 2 == 0 ? 1e12 : 1e8};
    const LocalTeam team(2 + seed % 4, 1 + seed % 2, localization_services, link);
    // The second time everybody knows how fast all are, and has served a problem before.
    for (int time = 0; time < 2; ++time) {
      const Result shared = localize(simulated.scene, settings, team.executor(), StopCondition());
      EXPECT_EQ(shared.stats.ranks, static_cast<int>(2 + seed % 4));
      EXPECT_EQ(answer(shared), answer(one));
    }
    elsewhere += team.executor().traffic().items;
  }
  EXPECT_GT(elsewhere, 2000U);
}

}  // namespace
}  // namespace perch
