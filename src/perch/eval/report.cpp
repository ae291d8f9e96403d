#include "perch/eval/report.hpp"

#include <map>
#include <system_error>

#include "perch/eval/figures.hpp"
#include "perch/eval/gnuplot.hpp"
#include "perch/eval/tables.hpp"
#include "perch/io/atomic_write.hpp"

namespace perch {
namespace {

constexpr const char* figure_names[] = {"thresholds.png", "thresholds.svg", "visibility.png",
                                        "visibility.svg"};

std::map<std::string, std::string> figures(const std::vector<MethodSummary>& summaries) {
  return {{"thresholds.png", run_gnuplot(threshold_figure(summaries, FigureFormat::png))},
          {"thresholds.svg", run_gnuplot(threshold_figure(summaries, FigureFormat::svg))},
          {"visibility.png", run_gnuplot(visibility_figure(summaries, FigureFormat::png))},
          {"visibility.svg", run_gnuplot(visibility_figure(summaries, FigureFormat::svg))}};
}

}  // namespace

std::string write_evaluation(const std::filesystem::path& folder, const std::vector<MethodRecord>& methods,
                             const std::vector<MethodSummary>& summaries) {
  OutputSet outputs;
  outputs.add("evaluation.json", evaluation_json(methods, summaries));
  outputs.add("objects.csv", objects_csv(methods));
  outputs.add("thresholds.csv", thresholds_csv(summaries));
  std::string no_figures;
  try {
    for (auto& [name, bytes] : figures(summaries)) outputs.add(name, bytes);
  } catch (const NoGnuplot& error) {
    no_figures = error.what();
  }
  outputs.commit(folder);
  std::error_code ignored;
  if (!no_figures.empty())
    for (const char* name : figure_names) std::filesystem::remove(folder / name, ignored);
  return no_figures;
}

void rehearse_evaluation(const std::filesystem::path& folder) {
  OutputSet outputs;
  for (const char* name : {"evaluation.json", "objects.csv", "thresholds.csv"}) outputs.add(name, "");
  for (const char* name : figure_names) outputs.add(name, "");
  outputs.rehearse(folder);
}

}  // namespace perch
