#include "perch/eval/tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "perch/io/message.hpp"

namespace perch {
namespace {

/// Columns of text as wide as what stands in them: the first to the left, the others to the right.
class TextTable {
 public:
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }

  std::string text() const {
    std::vector<std::size_t> widths;
    for (const auto& row : rows_)
      for (std::size_t i = 0; i < row.size(); ++i) {
        if (i == widths.size()) widths.push_back(0);
        widths[i] = std::max(widths[i], columns(row[i]));
      }
    std::string text;
    for (const auto& row : rows_) {
      std::string line;
      for (std::size_t i = 0; i < row.size(); ++i) {
        const std::size_t space = widths[i] - columns(row[i]);
        if (i == 0)
          line.append(row[i]).append(space, ' ');
        else
          line.append(space + 2, ' ').append(row[i]);
      }
      text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return text;
  }

 private:
  /// Characters of UTF-8 text.
  static std::size_t columns(const std::string& text) {
    return static_cast<std::size_t>(std::count_if(
        text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0U) != 0x80U; }));
  }

  std::vector<std::vector<std::string>> rows_;
};

std::string yaw_name(double yaw_deg) {
  return yaw_deg >= 180.0 ? "any" : fmt::format("{}°", yaw_deg);
}

std::string percent(double share) {
  return fmt::format("{:.1f}%", 100.0 * share);
}

std::string threshold_table(const std::vector<MethodSummary>& summaries) {
  TextTable table;
  std::vector<std::string> near{"objects within"}, turned{"and a yaw error below"};
  for (const double translation : paper_translations)
    for (const double yaw : paper_yaws_deg) {
      near.push_back(yaw == paper_yaws_deg.front() ? fmt::format("{:.0f} cm", 100.0 * translation) : "");
      turned.push_back(yaw_name(yaw));
    }
  table.add(near);
  table.add(turned);
  for (const MethodSummary& summary : summaries) {
    std::vector<std::string> row{one_line(summary.method)};
    for (const auto& tallies : summary.thresholds)
      for (const Tally& tally : tallies) row.push_back(std::to_string(tally.within));
    table.add(row);
  }
  return table.text();
}

std::string verdict_table(const std::vector<MethodSummary>& summaries) {
  TextTable table;
  table.add({"at 1 cm and 10°", "within", "ambiguous", "missed", "of", "not found", "surplus", "ADD(-S)",
             "AR", "VSD", "MSSD", "MSPD", "seconds"});
  for (const MethodSummary& s : summaries)
    table.add({one_line(s.method), std::to_string(s.right.within), std::to_string(s.right.ambiguous),
               std::to_string(s.right.missed()), std::to_string(s.right.objects), std::to_string(s.not_found),
               std::to_string(s.surplus), percent(s.recalls.add_or_s), percent(s.recalls.ar()),
               percent(s.recalls.ar_vsd), percent(s.recalls.ar_mssd), percent(s.recalls.ar_mspd),
               s.median_seconds ? fmt::format("{:.2f}", *s.median_seconds) : "-"});
  return table.text();
}

/// As RFC 4180 has it.
std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  quoted += '"';
  return quoted;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& text : cells) line.append(cell(text)).append(",");
  line.back() = '\n';
  return line;
}

/// Shortest text that reads back as the same double.
std::string number(double value) {
  return fmt::format("{}", value);
}

double in_degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

}  // namespace

std::string summary_table(const std::vector<MethodSummary>& summaries) {
  std::string text = threshold_table(summaries) + "\n" + verdict_table(summaries);
  for (const MethodSummary& summary : summaries) {
    if (summary.without_result.empty()) continue;
    constexpr std::size_t most = 10;
    text += fmt::format("{}: no result for {} of {} scenes, whose objects count as missed:",
                        one_line(summary.method), summary.without_result.size(), summary.scenes);
    for (std::size_t i = 0; i < std::min(most, summary.without_result.size()); ++i)
      text.append(" ").append(one_line(summary.without_result[i]));
    text += summary.without_result.size() > most ? " ...\n" : "\n";
  }
  return text;
}

std::string object_table(const std::vector<MethodRecord>& methods) {
  TextTable table;
  table.add({"scene", "object", "method", "visible", "error [mm]", "yaw [°]", "ADD [mm]", "ADD-S [mm]",
             "confidence", "verdict"});
  for (const MethodRecord& method : methods)
    for (const SceneRecord& scene : method.scenes)
      for (const ObjectRecord& object : scene.objects) {
        const auto error = [&](auto of, int digits) {
          return object.errors ? fmt::format("{:.{}f}", of(*object.errors), digits) : std::string("-");
        };
        table.add({one_line(scene.scene), one_line(object.model), one_line(method.method),
                   fmt::format("{:.0f}%", 100.0 * object.visible_fraction),
                   error([](const PoseErrors& e) { return 1000.0 * e.translation; }, 2),
                   error([](const PoseErrors& e) { return in_degrees(e.yaw); }, 2),
                   error([](const PoseErrors& e) { return 1000.0 * e.add; }, 2),
                   error([](const PoseErrors& e) { return 1000.0 * e.add_s; }, 2),
                   object.confidence ? fmt::format("{:.2f}", *object.confidence) : "-",
                   name(object.verdict(right_threshold))});
      }
  return table.text();
}

std::string objects_csv(const std::vector<MethodRecord>& methods) {
  std::vector<std::string> header{"method",
                                  "scene",
                                  "object",
                                  "model",
                                  "visible_fraction",
                                  "verdict",
                                  "translation_error_m",
                                  "yaw_error_deg",
                                  "add_m",
                                  "add_s_m",
                                  "mssd_m",
                                  "mspd_px",
                                  "diameter_m",
                                  "symmetric",
                                  "confidence",
                                  "cost_of_truth",
                                  "cost_of_estimate"};
  for (std::size_t i = 0; i < tolerance_count; ++i)
    header.push_back(fmt::format("vsd_{:02.0f}", 100.0 * tolerance(i)));
  std::string text = csv_line(header);
  for (const MethodRecord& method : methods)
    for (const SceneRecord& scene : method.scenes)
      for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const ObjectRecord& object = scene.objects[i];
        std::vector<std::string> row{method.method,
                                     scene.scene,
                                     std::to_string(i),
                                     object.model,
                                     number(object.visible_fraction),
                                     name(object.verdict(right_threshold))};
        if (const auto& e = object.errors)
          for (const double value : {e->translation, in_degrees(e->yaw), e->add, e->add_s, e->mssd, e->mspd})
            row.push_back(number(value));
        else
          row.insert(row.end(), 6, "");
        row.push_back(number(object.diameter));
        row.push_back(object.symmetric ? "1" : "0");
        row.push_back(object.confidence ? number(*object.confidence) : "");
        row.push_back(object.costs ? std::to_string(object.costs->of_truth) : "");
        row.push_back(object.costs ? std::to_string(object.costs->of_estimate) : "");
        for (std::size_t t = 0; t < tolerance_count; ++t)
          row.push_back(object.errors ? number(object.errors->vsd[t]) : "");
        text += csv_line(row);
      }
  return text;
}

std::string thresholds_csv(const std::vector<MethodSummary>& summaries) {
  std::string text = "method,translation_m,yaw_deg,within,ambiguous,missed,objects\n";
  for (const MethodSummary& summary : summaries)
    for (std::size_t t = 0; t < paper_translations.size(); ++t)
      for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y) {
        const Tally& tally = summary.thresholds[t][y];
        text += csv_line({summary.method, number(paper_translations[t]), number(paper_yaws_deg[y]),
                          std::to_string(tally.within), std::to_string(tally.ambiguous),
                          std::to_string(tally.missed()), std::to_string(tally.objects)});
      }
  return text;
}

}  // namespace perch
