#include "command_line_test_support.hpp"
#include "perch/localize/settings.hpp"

// Bad flags, settings and output folders: status 2, one line that says what to do, nothing written.
namespace perch::command_line {
namespace {

class OptionRefusals : public CommandLine {
 protected:
  /// `localize` of the good scene with these options must be refused.
  void refused(Arguments options, const std::vector<std::string>& words) const {
    SCOPED_TRACE(::testing::PrintToString(options));
    options.insert(options.begin(), {"localize", "scene.yaml", "-o", "out"});
    expect_refused(options, words);
  }
};

TEST_F(OptionRefusals, ValuesOutOfRange) {
  const std::vector<std::tuple<std::string, std::vector<std::string>, std::string>> flags{
      {"--resolution", {"0", "-1", "nan", "inf", "coarse", "", "0.04m"}, "grid.resolution"},
      {"--yaw-resolution-deg", {"0", "-22.5", "nan", "x"}, "grid.yaw_resolution_deg"},
      {"--delta", {"0", "-1", "nan", "1e999"}, "cost.delta"},
      {"--w", {"0.5", "nan", "inf", "-3", "three"}, "search.w"},
      {"--time-limit", {"0", "-1", "nan", "soon", "inf"}, "search.time_limit"},
      {"--threads", {"-1", "100000", "2.5", "many", "99999999999999999999999"}, "threads"},
      {"--max-expansions", {"-1", "1.5", "all"}, "search.max_expansions"},
      {"--refine", {"ndt", "ICP"}, "refine.method"},
      {"--candidates", {"some"}, "search.candidates"},
      {"--search", {"a-star"}, "search.method"}};
  for (const auto& [flag, values, field] : flags)
    for (const std::string& value : values) {
      refused({flag + "=" + value}, {flag});
      refused({flag, value}, {flag});
      if (!value.empty()) refused({"--set", field + "=" + value}, {field});
    }
}

TEST_F(OptionRefusals, WhatNeedsFixedCandidatesIsRefusedInContext) {
  refused({"--search", "branch-and-bound", "--candidates", "context"},
          {"search.method is branch-and-bound", "--candidates fixed", "--search focal-mha"});
  refused({"--set", "search.method=branch-and-bound", "--set", "search.candidates=context"},
          {"search.method is branch-and-bound", "--candidates fixed"});
  refused({"--exhaustive", "--candidates", "context"}, {"search.exhaustive is true", "--candidates fixed"});
  refused({"--exhaustive", "--candidates", "context", "--search", "focal-mha"}, {"--candidates fixed"});
  refused({"--set", "search.exhaustive=true", "--candidates", "context"}, {"--candidates fixed"});
  write(folder() / "context.yaml", "search: {candidates: context, method: branch-and-bound}\n");
  refused({"--settings", "context.yaml"}, {"search.method is branch-and-bound", "--candidates fixed"});
}

TEST_F(OptionRefusals, BranchAndBoundNeedsTheLagrangianBound) {
  for (const std::string bound : {"none", "cover"})
    refused({"--set", "search.bound=" + bound, "--search", "branch-and-bound"},
            {"search.bound is " + bound, "--search focal-mha"});
  refused({"--set", "search.bound=all"}, {"search.bound", "none, cover, lagrangian"});
}

TEST_F(OptionRefusals, AGridTooFineSaysHowManyPoses) {
  // 44,001 x 32,001 places with one yaw for the can and 16 for the mug.
  refused({"--resolution", "0.00001"}, {"scene.yaml", "23937292017 poses", "--resolution", "grid.max_poses"});
  refused({"--yaw-resolution-deg", "1e-9"}, {"scene.yaml", "poses", "--yaw-resolution-deg"});
  refused({"--resolution", "1e-300"}, {"scene.yaml", "poses", "--resolution"});
}

TEST_F(OptionRefusals, Usage) {
  expect_refused({}, {"subcommand"});
  expect_refused({"locate", "scene.yaml"}, {"subcommand"});
  expect_refused({"localize", "-o", "out"}, {"scenes"});
  refused({"--resolutoin", "0.04"}, {"--resolutoin"});
  refused({"--resolution"}, {"--resolution"});
  refused({"two\nlines.yaml"}, {"lines.yaml"});
  refused({"--two\nlines\nthree"}, {"lines"});
  refused({"--set"}, {"--set"});
  refused({"--set", "cost.delta"}, {"--set cost.delta", "key=value"});
  refused({"--set", "two\nlines\nor three"}, {"--set two", "key=value"});
  refused({"--set", "cost.deltas=0.005"}, {"cost.deltas", "unknown setting", "cost.delta"});
  refused({"--set", "=0.005"}, {"unknown setting"});
  refused({"--set", "cost.delta="}, {"cost.delta"});
  refused({"--set", "cost.delta=0.005=6"}, {"cost.delta"});
  refused({"--set", "cost.delta=1\n2\n3"}, {"cost.delta"});
  refused({"--set", "cost.missing_depth=maybe"}, {"cost.missing_depth", "unexplained", "ignore"});
}

TEST_F(OptionRefusals, EveryFieldRefusesNonsense) {
  for (const SettingsField& field : settings_fields()) refused({"--set", field.key + "=?"}, {field.key});
}

TEST_F(OptionRefusals, SettingsFiles) {
  refused({"--settings", "none.yaml"}, {"none.yaml", "no such file"});
  refused({"--settings", "models"}, {"models", "is a directory"});
  refused({"--settings", "depth.png"}, {"depth.png"});
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"", {"is empty"}},
      {"cost: {delta", {"line"}},
      {"[cost.delta, 0.005]", {"no map of settings"}},
      {"0.005", {"no map of settings"}},
      {"cost: 0.005", {"cost", "unknown setting"}},
      {"cost: {deltas: 0.005}", {"cost.deltas", "unknown setting"}},
      {"cost: {delta: small}", {"cost.delta", "not a number"}},
      {"cost: {delta: -1}", {"cost.delta", "-1"}},
      {"cost: {delta: [0.005]}", {"cost.delta", "no single value"}},
      {"cost: {delta:}", {"cost.delta"}},
      {"search: {method: exhaustive}", {"search.method", "branch-and-bound", "focal-mha"}},
      {"search: {anytime: 1}", {"search.anytime", "true or false"}},
      {"search: {exhaustive: yes}", {"search.exhaustive", "true or false"}},
      {"cost.delta: 0.005\ncost.delta: 0.006", {"cost.delta", "given twice"}},
      {"cost.delta: 0.005\ncost: {delta: 0.006}", {"cost.delta", "given twice"}},
      {"? [a]\n: 1\n", {"plain word"}},
      {"cost: &a {delta: 0.005, more: *a}", {}},
      {"&a cost: *a", {}},
      {"&a {cost: *a}", {"nested too deep"}},
      {"&a [*a]", {"no map of settings"}},
      {std::string(50000, '{'), {}},
      {std::string(50000, '['), {}},
      {std::string("\x00\xff\x01", 3), {}},
      {"search.w: 3\n---\nsearch.w: 4\n", {"2 YAML documents"}},
  };
  for (const auto& [text, words] : cases) {
    SCOPED_TRACE(text.substr(0, 200));
    write(folder() / "settings.yaml", text);
    std::vector<std::string> all{"settings.yaml"};
    all.insert(all.end(), words.begin(), words.end());
    refused({"--settings", "settings.yaml"}, all);
  }
}

TEST_F(OptionRefusals, OutputFolders) {
  const auto to = [&](const Arguments& scenes, const std::string& output,
                      const std::vector<std::string>& words) {
    SCOPED_TRACE(output);
    Arguments arguments{"localize", "-o", output};
    arguments.insert(arguments.end(), scenes.begin(), scenes.end());
    expect_refused(coarse(arguments), words);
  };
  to({"scene.yaml"}, "depth.png", {"depth.png", "not a directory", "choose another place"});
  to({"scene.yaml"}, "depth.png/out", {"depth.png/out"});
  to({"scene.yaml"}, "a/b/../../depth.png/x/y", {"depth.png/x"});
  to({"scene.yaml", "scene.yaml"}, "depth.png", {"depth.png"});
  fs::create_directories(folder() / "taken/result.json");
  to({"scene.yaml"}, "taken", {"taken/result.json", "it is a directory"});
  fs::create_directories(folder() / "later/picture.png");
  to({"scene.yaml"}, "later", {"later/picture.png", "it is a directory"});
  fs::create_symlink("nowhere/at/all", folder() / "dangling");
  to({"scene.yaml"}, "dangling", {"dangling"});
  to({"scene.yaml"}, "/dev/null/out", {"/dev/null/out"});
  to({"scene.yaml"}, std::string(300, 'a'), {"aaaa"});
}

}  // namespace
}  // namespace perch::command_line
