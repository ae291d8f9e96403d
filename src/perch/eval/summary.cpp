#include "perch/eval/summary.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace perch {
namespace {

/// Adds what one object counts, in whole numbers: of the average recalls, at how many thresholds it counts.
void count_object(const ObjectRecord& object, Recalls& counts) {
  if (!object.errors) return;
  const PoseErrors& e = *object.errors;
  const bool add = e.add < 0.1 * object.diameter, add_s = e.add_s < 0.1 * object.diameter;
  counts.add += add;
  counts.add_s += add_s;
  counts.add_or_s += object.symmetric ? add_s : add;
  for (std::size_t i = 0; i < tolerance_count; ++i) {
    counts.ar_mssd += e.mssd < tolerance(i) * object.diameter;
    counts.ar_mspd += e.mspd < 100.0 * tolerance(i);  // 5 to 50 pixels
    for (const double vsd : e.vsd) counts.ar_vsd += vsd < tolerance(i);
  }
}

void divide(Recalls& counts, std::size_t objects) {
  if (objects == 0) return;
  const double all = static_cast<double>(objects), n = tolerance_count;
  for (double* share : {&counts.add, &counts.add_s, &counts.add_or_s}) *share /= all;
  for (double* share : {&counts.ar_mssd, &counts.ar_mspd}) *share /= all * n;
  counts.ar_vsd /= all * n * n;
}

std::optional<double> mean(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

void count_object(const ObjectRecord& object, MethodSummary& summary) {
  summary.not_found += !object.errors;
  for (std::size_t t = 0; t < paper_translations.size(); ++t)
    for (std::size_t y = 0; y < paper_yaws_deg.size(); ++y)
      summary.thresholds[t][y].add(object.verdict({paper_translations[t], degrees(paper_yaws_deg[y])}));
  const Verdict verdict = object.verdict(right_threshold);
  summary.right.add(verdict);
  const auto bin =
      static_cast<std::size_t>(object.visible_fraction * static_cast<double>(summary.visibility.size()));
  summary.visibility[std::min(bin, summary.visibility.size() - 1)].tally.add(verdict);
  count_object(object, summary.recalls);
}

}  // namespace

void Tally::add(Verdict verdict) {
  ++objects;
  within += verdict == Verdict::within;
  ambiguous += verdict == Verdict::ambiguous;
}

MethodSummary summarize(const MethodRecord& record) {
  constexpr int bins = 5;
  MethodSummary summary;
  summary.method = record.method;
  summary.scenes = record.scenes.size();
  for (int i = 0; i < bins; ++i)
    summary.visibility.push_back({i / static_cast<double>(bins), (i + 1) / static_cast<double>(bins), {}});
  std::vector<double> seconds, rendered, expanded, bounds;
  for (const SceneRecord& scene : record.scenes) {
    if (scene.run) {
      seconds.push_back(scene.run->seconds);
      rendered.push_back(static_cast<double>(scene.run->rendered));
      expanded.push_back(static_cast<double>(scene.run->expanded));
      if (scene.run->suboptimality_bound) bounds.push_back(*scene.run->suboptimality_bound);
    } else {
      summary.without_result.push_back(scene.scene);
    }
    summary.surplus += scene.surplus;
    for (const ObjectRecord& object : scene.objects) count_object(object, summary);
  }
  divide(summary.recalls, summary.right.objects);
  summary.mean_seconds = mean(seconds);
  summary.median_seconds = median(seconds);
  summary.median_rendered = median(rendered);
  summary.mean_expanded = mean(expanded);
  summary.bounded = bounds.size();
  if (!bounds.empty()) summary.largest_bound = *std::max_element(bounds.begin(), bounds.end());
  summary.median_bound = median(bounds);
  return summary;
}

std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials) {
  constexpr double z = 1.959963984540054;  // of the normal distribution, both tails 5 %
  const double n = static_cast<double>(trials), share = static_cast<double>(successes) / n;
  const double middle = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace perch
