#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

// Layers may include only what stands below them (docs/conventions.md). The linker does not see a wrong
// #include, so this test reads the lines themselves.
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// What each layer may include besides itself.
const std::map<std::string, std::set<std::string>>& allowed_layers() {
  static const auto all = [] {
    std::map<std::string, std::set<std::string>> allowed{{"search", {"core"}}, {"parallel", {"core"}}};
    // From the lowest to the highest; each may include all before it, but search only from the tree on.
    const std::vector<std::string> stack{"core",   "parallel",   "model", "render",     "observation", "cost",
                                         "refine", "candidates", "tree",  "heuristics", "localize"};
    std::set<std::string> below;
    for (const std::string& layer : stack) {
      if (layer == "tree") below.insert("search");
      allowed.try_emplace(layer, below);
      below.insert(layer);
    }
    // Beside the stack, for programs and tests.
    allowed["io"] = {"core", "model", "observation"};
    allowed["sim"] = {"core", "model", "render", "io"};
    allowed["baselines"] = {"core", "parallel", "model", "render", "observation", "cost", "refine"};
    allowed["eval"] = {"core", "model", "render", "io"};
    allowed["verify"] = {"core", "io"};
    allowed["mpi"] = {"core", "parallel"};
    return allowed;
  }();
  return all;
}

/// Plain data that a layer beside the stack may use without the rest of the layer it is of. \param included
/// relative to src/.
bool is_data_for(const std::string& layer, const std::string& included) {
  static const std::set<std::string> beside{"io", "sim", "baselines", "eval", "verify"};
  static const std::set<std::string> data{"perch/localize/scene.hpp", "perch/localize/result.hpp",
                                          "perch/localize/settings.hpp"};
  // What checks a result must not be made of what made it.
  if (layer == "verify" && included == "perch/model/mesh.hpp") return true;
  // The baselines are given the same grid.
  if (layer == "baselines" && included == "perch/candidates/grid.hpp") return true;
  return beside.contains(layer) && data.contains(included);
}

bool is_test_support(const std::string& name) {
  return name.ends_with("_test_support.hpp") || (name.starts_with("test_") && name.ends_with(".hpp"));
}

/// What is wrong with a source under src/perch that includes `included`, or nothing. \param source relative
/// to src/, e.g. "perch/tree/monotone.cpp".
std::optional<std::string> violation(const std::string& source, const std::string& included) {
  // The middle of perch/<layer>/<name>.
  const auto layer_of = [](const std::string& path) -> std::optional<std::string> {
    constexpr std::string_view root = "perch/";
    const std::size_t end = path.find('/', root.size());
    if (!path.starts_with(root) || end == std::string::npos) return std::nullopt;
    return path.substr(root.size(), end - root.size());
  };
  const auto says = [&](const std::string& what) { return source + " includes " + included + ": " + what; };
  const auto from = layer_of(source), to = layer_of(included);
  if (!from || !allowed_layers().contains(*from)) return source + " lies in no known layer";
  if (!to) return says("write the path from src/, perch/<layer>/<name>.hpp");
  if (!allowed_layers().contains(*to)) return says(*to + " is no layer");
  const std::string name = fs::path(source).filename().string(),
                    header = fs::path(included).filename().string();
  if (is_test_support(header) && !is_test_support(name) && !name.ends_with("_test.cpp"))
    return says("support for tests is for tests");
  if (*from == *to || allowed_layers().at(*from).contains(*to)) return std::nullopt;
  if (is_data_for(*from, included)) return std::nullopt;
  return says(*from + " must not know " + *to);
}

/// The header that a line includes: any in quotes, and those of perch in angle brackets.
std::optional<std::string> included_by(std::string_view line) {
  const auto skip = [&](std::string_view word) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    const bool there = line.starts_with(word);
    if (there) line.remove_prefix(word.size());
    return there;
  };
  if (!skip("#") || !skip("include")) return std::nullopt;
  const bool quoted = skip("\"");
  if (!quoted && (!skip("<") || !line.starts_with("perch/"))) return std::nullopt;
  return std::string(line.substr(0, line.find(quoted ? '"' : '>')));
}

std::vector<std::string> includes_of(std::istream& source) {
  std::vector<std::string> included;
  for (std::string line; std::getline(source, line);)
    if (auto header = included_by(line)) included.push_back(*std::move(header));
  return included;
}

std::vector<std::string> violations_of(const std::string& source, std::istream& text) {
  std::vector<std::string> found;
  for (const std::string& included : includes_of(text))
    if (const auto wrong = violation(source, included)) found.push_back(*wrong);
  return found;
}

bool is_source(const fs::path& path) {
  static const std::set<std::string> endings{".hpp", ".cpp", ".h", ".cu", ".cuh"};
  return endings.contains(path.extension().string());
}

TEST(Layering, HoldsInEverySource) {
  const fs::path root = fs::path(PERCH_SOURCE_DIR) / "src";
  int sources = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file() || !is_source(entry.path())) continue;
    ++sources;
    std::ifstream text(entry.path());
    EXPECT_THAT(violations_of(fs::relative(entry.path(), root).generic_string(), text), IsEmpty());
  }
  EXPECT_GT(sources, 100);  // it did look at them
}

TEST(Layering, ReadsEveryWayToWriteAnInclude) {
  std::istringstream text(
      "#pragma once\n"
      "#include <vector>\n"
      "#include \"perch/core/pose.hpp\"\n"
      "  #  include <perch/model/mesh.hpp>  // comment\n"
      "// #include \"perch/io/png.hpp\"\n"
      "#include\"../apps/perch/command.hpp\"\r\n");
  EXPECT_THAT(includes_of(text),
              ElementsAre("perch/core/pose.hpp", "perch/model/mesh.hpp", "../apps/perch/command.hpp"));
}

TEST(Layering, ReportsSourceAndHeader) {
  std::istringstream text("#include \"perch/core/pose.hpp\"\n#include \"perch/tree/monotone.hpp\"\n");
  EXPECT_THAT(
      violations_of("perch/cost/made_up.cpp", text),
      ElementsAre("perch/cost/made_up.cpp includes perch/tree/monotone.hpp: cost must not know tree"));
}

struct Case {
  std::string source, included;
};

class Forbidden : public testing::TestWithParam<Case> {};
TEST_P(Forbidden, IsReported) {
  EXPECT_TRUE(violation(GetParam().source, GetParam().included));
}
INSTANTIATE_TEST_SUITE_P(
    Layering, Forbidden,
    testing::Values(Case{"perch/core/a.hpp", "perch/model/mesh.hpp"},                 // upwards
                    Case{"perch/render/a.cpp", "perch/observation/observation.hpp"},  // to the next
                    Case{"perch/search/a.hpp", "perch/parallel/executor.hpp"},        // search: core alone
                    Case{"perch/parallel/a.cpp", "perch/search/search_problem.hpp"},  // parallel: core alone
                    Case{"perch/cost/a.cpp", "perch/search/search_problem.hpp"},      // search below the tree
                    Case{"perch/candidates/a.cpp", "perch/search/focal_mha.hpp"},
                    Case{"perch/localize/a.cpp", "perch/io/png.hpp"},  // the stack knows nothing beside it
                    Case{"perch/cost/a_test.cpp", "perch/sim/depth_sensor.hpp"},  // its tests neither
                    Case{"perch/io/a.cpp", "perch/localize/localize.hpp"},        // data of localize alone
                    Case{"perch/io/a.cpp", "perch/render/rasterizer.hpp"},
                    Case{"perch/sim/a.cpp", "perch/cost/explanation_cost.hpp"},
                    Case{"perch/baselines/a.cpp", "perch/tree/scene_tree.hpp"},
                    Case{"perch/baselines/a.cpp", "perch/candidates/first_scenes.hpp"},
                    Case{"perch/eval/a.cpp", "perch/localize/setup.hpp"},
                    Case{"perch/eval/a.cpp", "perch/cost/explanation_cost.hpp"},
                    Case{"perch/verify/a.cpp", "perch/render/rasterizer.hpp"},
                    Case{"perch/verify/a.cpp", "perch/observation/observation.hpp"},
                    Case{"perch/verify/a.cpp", "perch/model/collision.hpp"},
                    Case{"perch/verify/a.cpp", "perch/localize/report.hpp"},
                    Case{"perch/localize/a.cpp", "perch/verify/verify.hpp"},
                    Case{"perch/tree/a.cpp", "perch/search/random_graphs_test_support.hpp"},
                    Case{"perch/core/a.cpp", "../apps/perch/command.hpp"},  // programs
                    Case{"perch/core/a.cpp", "command.hpp"},                // no layer in the path
                    Case{"perch/core/a.cpp", "perch/pose.hpp"},             // no layer in the path
                    Case{"perch/core/a.cpp", "perch/unheard_of/pose.hpp"},  // no such layer
                    Case{"perch/unheard_of/a.cpp", "perch/core/pose.hpp"}));

class Allowed : public testing::TestWithParam<Case> {};
TEST_P(Allowed, IsNotReported) {
  EXPECT_EQ(violation(GetParam().source, GetParam().included), std::nullopt);
}
INSTANTIATE_TEST_SUITE_P(Layering, Allowed,
                         testing::Values(Case{"perch/core/a.cpp", "perch/core/pose.hpp"},
                                         Case{"perch/model/a.cpp", "perch/parallel/executor.hpp"},
                                         Case{"perch/tree/a.hpp", "perch/search/search_problem.hpp"},
                                         Case{"perch/tree/a_test.cpp",
                                              "perch/search/random_graphs_test_support.hpp"},
                                         Case{"perch/localize/a.cpp", "perch/search/focal_mha.hpp"},
                                         Case{"perch/localize/a.cpp", "perch/core/pose.hpp"},
                                         Case{"perch/io/a.hpp", "perch/localize/scene.hpp"},
                                         Case{"perch/sim/a.hpp", "perch/localize/scene.hpp"},
                                         Case{"perch/sim/a_test.cpp", "perch/io/test_scene.hpp"},
                                         Case{"perch/baselines/a.hpp", "perch/candidates/grid.hpp"},
                                         Case{"perch/baselines/a.cpp", "perch/cost/explanation_cost.hpp"},
                                         Case{"perch/eval/a.cpp", "perch/localize/result.hpp"},
                                         Case{"perch/eval/a.cpp", "perch/render/rasterizer.hpp"},
                                         Case{"perch/verify/a.cpp", "perch/model/mesh.hpp"},
                                         Case{"perch/verify/a.hpp", "perch/io/result_file.hpp"},
                                         Case{"perch/verify/a.cpp", "perch/localize/settings.hpp"}));

}  // namespace
