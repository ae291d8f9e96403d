#include "command_line_result_checks.hpp"

// What `perch localize` proves: anytime, at its limits, by enumeration, with objects that may be absent.
namespace perch::command_line {
namespace {

using ::testing::HasSubstr;

class Proof : public CommandLine {
 protected:
  /// Runs `localize` and checks all of what it writes.
  Json answer(Arguments arguments, const std::vector<std::string>& objects = {"can", "mug"}) {
    arguments.insert(arguments.begin(), "localize");
    arguments.insert(arguments.end(), {"-o", "out"});
    outcome = run(arguments);
    EXPECT_EQ(outcome.err, "");
    const Json result = json("out/result.json");
    check_keys(result);
    check_objects(result, objects);
    check_certificate(result);
    check_trace(bytes_of(folder() / "out/trace.jsonl"), result);
    EXPECT_EQ(outcome.status, result.at("status") == "solved" ? 0 : 3) << outcome;
    return result;
  }

  Outcome outcome;
};

/// Too slow for sanitizers.
class ProofHeavy : public Proof {};

TEST_F(Proof, AnytimeEndsWhenTheSceneIsProvenOptimal) {
  for (const std::string search : {"branch-and-bound", "focal-mha"}) {
    const Json result = answer(coarse({"scene.yaml", "--anytime", "--search", search}));
    EXPECT_EQ(result.at("search_cost"), result.at("lower_bound")) << search;
    EXPECT_EQ(result.at("guarantee").at("w"), 3.0);
  }
}

// The first solution is handed out at once without --anytime; both searches say what they have proven of it.
TEST_F(ProofHeavy, AtALimitTheStatusFollowsTheBound) {
  int solved = 0, unproven = 0;
  for (const std::string expansions : {"0", "2"})
    for (const std::string w : {"1", "20"})
      for (const Arguments& more : {Arguments{"--search", "focal-mha"}, {"--set", "search.bound=none"}}) {
        Arguments arguments = coarse({"scene.yaml", "--anytime", "--max-expansions", expansions, "--w", w});
        arguments.insert(arguments.end(), more.begin(), more.end());
        ++(answer(arguments).at("status") == "solved" ? solved : unproven);
      }
  EXPECT_GT(solved, 0);
  EXPECT_GT(unproven, 0);
}

TEST_F(ProofHeavy, EnumerationFindsWhatTheSearchesProveOptimal) {
  for (const std::string search : {"branch-and-bound", "focal-mha"}) {
    const Json searched = answer(coarse({"scene.yaml", "--w", "1", "--search", search}));
    const Json enumerated = answer(coarse({"scene.yaml", "--exhaustive", "--search", search}));
    EXPECT_EQ(enumerated.at("guarantee").at("search"), "exhaustive");
    EXPECT_EQ(enumerated.at("guarantee").at("over"), searched.at("guarantee").at("over"));
    EXPECT_EQ(enumerated.at("lower_bound"), enumerated.at("search_cost"));
    EXPECT_EQ(enumerated.at("search_cost"), searched.at("search_cost"));
    EXPECT_GT(enumerated.at("stats").at("expanded"), searched.at("stats").at("expanded"));
  }
}

TEST_F(Proof, EnumerationOfTooManyScenesIsRefused) {
  write(folder() / "many.yaml", with_line(yaml, "objects:", "objects: [mug, mug, mug, mug, can]"));
  expect_refused(coarse({"localize", "many.yaml", "--exhaustive", "-o", "out"}),
                 {"many.yaml", "10000000 can be enumerated"});
}

TEST_F(ProofHeavy, AnObjectThatIsNotInTheImageIsAbsent) {
  write(folder() / "more.yaml",
        with_line(yaml, "objects:",
                  "objects: [{model: can, optional: true}, mug, can, {model: mug, optional: true}]"));
  const Json result = answer(coarse({"more.yaml"}), {"can", "mug", "can", "mug"});
  const Json &first = result.at("objects")[0], &third = result["objects"][2];
  EXPECT_NE(first.contains("absent"), third.contains("absent")) << "there is one can";
  EXPECT_TRUE(result["objects"][3].contains("absent"));
  EXPECT_FALSE(result["objects"][1].contains("absent"));
  EXPECT_THAT(outcome.out, HasSubstr("absent"));
  // The best scene is the one without it.
  const Json best = answer(coarse({"more.yaml", "--w", "1"}), {"can", "mug", "can", "mug"});
  EXPECT_EQ(best.at("search_cost"), answer(coarse({"scene.yaml", "--w", "1"})).at("search_cost"));
#ifdef PERCH_HAS_VERIFY
  const Json again = answer(coarse({"more.yaml"}), {"can", "mug", "can", "mug"});
  EXPECT_EQ(run({"verify", "more.yaml", "out/result.json"}).status, 0);
#endif
}

// One that is listed as required is placed, however badly that explains the image.
TEST_F(ProofHeavy, WhatIsNotOptionalIsPlaced) {
  write(folder() / "more.yaml", with_line(yaml, "objects:", "objects: [can, mug, mug]"));
  const Json result = answer(coarse({"more.yaml"}), {"can", "mug", "mug"});
  for (const Json& object : result.at("objects")) EXPECT_FALSE(object.contains("absent"));
  EXPECT_GT(result.at("cost"), answer(coarse({"scene.yaml"})).at("cost"));
}

}  // namespace
}  // namespace perch::command_line
