#include "perch/eval/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "perch/io/message.hpp"

namespace perch {
namespace {

/// The share of objects that are not right, and the mean error: ascending from the best.
std::pair<double, double> badness(const SceneRecord& scene) {
  constexpr double most = 0.10;  // metres
  std::size_t wrong = 0;
  double error = 0.0;
  for (const ObjectRecord& object : scene.objects) {
    wrong += !object.errors || !right_threshold.holds(*object.errors);
    error += object.errors ? std::min(most, object.errors->translation) : most;
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, scene.objects.size()));
  return {static_cast<double>(wrong) / n, error / n};
}

/// As a cell of a table can hold it.
std::string in_cell(const std::string& text) {
  std::string escaped;
  for (const char c : one_line(text)) {
    if (c == '|' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string row(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) line.append(" ").append(cell).append(" |");
  return line + "\n";
}

std::string table(const std::vector<std::vector<std::string>>& rows) {
  std::string text = row(rows.front()) + "|---|";
  for (std::size_t i = 1; i < rows.front().size(); ++i) text += "---:|";
  text += "\n";
  for (std::size_t i = 1; i < rows.size(); ++i) text += row(rows[i]);
  return text;
}

std::string or_dash(const std::optional<double>& value, int digits) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
}

std::string yaw_limit(double yaw_deg) {
  return yaw_deg >= 180.0 ? "any yaw" : fmt::format("{}°", yaw_deg);
}

std::string recall_table(const std::vector<MethodSummary>& summaries) {
  std::vector<std::string> header{"of " +
                                  std::to_string(summaries.empty() ? 0 : summaries.front().right.objects) +
                                  " objects, percent within"};
  for (const double translation : paper_translations)
    for (const double yaw : paper_yaws_deg)
      header.push_back(fmt::format("{:.0f} cm, {}", 100.0 * translation, yaw_limit(yaw)));
  std::vector<std::vector<std::string>> rows{header};
  for (const MethodSummary& summary : summaries) {
    std::vector<std::string> cells{in_cell(summary.method)};
    for (const auto& tallies : summary.thresholds)
      for (const Tally& tally : tallies)
        cells.push_back(tally.objects == 0 ? "-"
                                           : fmt::format("{:.1f}", 100.0 * static_cast<double>(tally.within) /
                                                                       static_cast<double>(tally.objects)));
    rows.push_back(cells);
  }
  return table(rows);
}

std::string effort_table(const std::vector<MethodSummary>& summaries) {
  std::vector<std::vector<std::string>> rows{{"over scenes", "mean s", "median s", "hypotheses, median",
                                              "bound, median", "bound, largest", "scenes with a bound",
                                              "right", "ambiguous", "missed", "not found"}};
  for (const MethodSummary& s : summaries)
    rows.push_back({in_cell(s.method), or_dash(s.mean_seconds, 2), or_dash(s.median_seconds, 2),
                    or_dash(s.median_rendered, 0), or_dash(s.mean_expanded, 1), or_dash(s.median_bound, 3),
                    or_dash(s.largest_bound, 3), fmt::format("{} of {}", s.bounded, s.scenes),
                    std::to_string(s.right.within), std::to_string(s.right.ambiguous),
                    std::to_string(s.right.missed()), std::to_string(s.not_found)});
  return table(rows);
}

}  // namespace

std::vector<std::size_t> ranked_scenes(const MethodRecord& record) {
  std::vector<std::size_t> order(record.scenes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return badness(record.scenes[a]) < badness(record.scenes[b]);
  });
  return order;
}

std::string comparison_tables(const std::vector<MethodSummary>& summaries) {
  return recall_table(summaries) + "\n" + effort_table(summaries) +
         "\nRight: within 1 cm and 10 degrees, modulo the object's symmetry. Ambiguous: not right, but J is "
         "no "
         "higher than at the true pose, so that the view doesn't tell the two apart.\n";
}

std::string comparison_page(const std::string& introduction, const std::vector<MethodSummary>& summaries,
                            const std::vector<ShownPicture>& pictures) {
  std::string page = "# Benchmark\n\n" + introduction + "\n\n" + comparison_tables(summaries);
  for (const ShownPicture& picture : pictures)
    page += fmt::format("\n{}\n\n![{}]({})\n", one_line(picture.caption), one_line(picture.caption),
                        picture.file);
  return page;
}

}  // namespace perch
