#include "perch/verify/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace perch {
namespace {

template <typename T>
std::string text(const std::optional<T>& value) {
  return value ? fmt::format("{}", *value) : "null";
}

class CertificateCheck {
 public:
  CertificateCheck(const Scene& scene, const ReportedResult& result, Checks& checks)
      : scene_(scene), result_(result), checks_(checks) {}

  void run() {
    check_counts();
    if (has_scene()) check_costs();
    check_bound();
    check_status();
    if (has_scene()) check_models();
  }

 private:
  void add(const std::string& what, std::string reported, std::string recomputed, bool holds) {
    checks_.push_back({what, std::move(reported), std::move(recomputed), holds});
  }

  /// A result has a scene if it says so anywhere; that it does so everywhere is checked.
  bool has_scene() const {
    return result_.cost || result_.cost_observed || result_.cost_rendered || result_.search_cost ||
           !result_.objects.empty() || !result_.search_objects.empty();
  }

  void check_counts() {
    std::vector<std::pair<std::string, std::int64_t>> counts{
        {"observed_points", result_.observed_points},           {"lower_bound", result_.lower_bound},
        {"guarantee.candidates", result_.guarantee.candidates}, {"stats.rendered", result_.stats.rendered},
        {"stats.generated", result_.stats.generated},           {"stats.expanded", result_.stats.expanded}};
    const auto optional = [&](const char* key, const std::optional<std::int64_t>& count) {
      if (count) counts.emplace_back(key, *count);
    };
    optional("cost", result_.cost);
    optional("cost_observed", result_.cost_observed);
    optional("cost_rendered", result_.cost_rendered);
    optional("search_cost", result_.search_cost);
    for (std::size_t i = 0; i < result_.objects.size(); ++i)
      counts.emplace_back(fmt::format("objects[{}].visible_pixels", i), result_.objects[i].visible_pixels);
    std::string negative;
    for (const auto& [key, count] : counts)
      if (count < 0) negative += fmt::format("{}{} {}", negative.empty() ? "" : ", ", key, count);
    add("counts", negative.empty() ? "none below 0" : negative, "none below 0", negative.empty());
    if (!result_.has_bound()) return;
    const double w = result_.guarantee.w;
    add("guarantee.w", fmt::format("{}", w), "at least 1", w >= 1.0);
  }

  void check_costs() {
    const auto& [cost, observed, rendered] =
        std::tie(result_.cost, result_.cost_observed, result_.cost_rendered);
    const bool all = cost && observed && rendered;
    add("cost = cost_observed + cost_rendered", text(cost),
        all ? fmt::format("{}", *observed + *rendered) : "not null", all && *cost == *observed + *rendered);
    if (!result_.has_bound()) return;
    add("cost <= search_cost", text(cost), fmt::format("at most {}", text(result_.search_cost)),
        cost && result_.search_cost && *cost <= *result_.search_cost);
    add("lower_bound <= search_cost", fmt::format("{}", result_.lower_bound),
        fmt::format("at most {}", text(result_.search_cost)),
        result_.search_cost && result_.lower_bound <= *result_.search_cost);
  }

  void check_bound() {
    std::optional<double> bound;
    if (result_.search_cost && result_.lower_bound != 0)
      bound = static_cast<double>(*result_.search_cost) / static_cast<double>(result_.lower_bound);
    else if (result_.search_cost == 0)
      bound = 1.0;
    const auto& reported = result_.suboptimality_bound;
    constexpr double rounding = 1e-15;  // another program may divide and print in another way
    add("suboptimality_bound", text(reported), text(bound),
        reported.has_value() == bound.has_value() &&
            (!bound || std::abs(*reported - *bound) <= rounding * std::abs(*bound)));
  }

  /// A method without a bound: nothing is stated that only a search can know.
  void check_unproven() {
    add("lower_bound", fmt::format("{}, no bound to check", result_.lower_bound), "0",
        result_.lower_bound == 0);
    add("search_cost", text(result_.search_cost), "null", !result_.search_cost);
    add("search_objects", fmt::format("{}", result_.search_objects.size()), "0",
        result_.search_objects.empty());
    add("status", std::string(name(result_.status)), "unproven or time_limit",
        result_.status == Status::unproven || result_.status == Status::time_limit);
  }

  void check_status() {
    if (!result_.has_bound()) return check_unproven();
    const double w = result_.guarantee.w;
    std::string wanted;
    bool holds = false;
    if (!result_.search_cost) {
      wanted = "infeasible or time_limit";
      holds = result_.status == Status::infeasible || result_.status == Status::time_limit;
    } else {
      const double cost = static_cast<double>(*result_.search_cost),
                   most = w * static_cast<double>(result_.lower_bound);
      const bool proven = cost <= most;
      wanted = fmt::format("{}: {} {} {} x {}", proven ? "solved" : "time_limit", *result_.search_cost,
                           proven ? "<=" : ">", w, result_.lower_bound);
      holds = result_.status == (proven ? Status::solved : Status::time_limit);
    }
    add("status", std::string(name(result_.status)), wanted, holds);
  }

  void check_models() {
    const auto& objects = scene_.objects;
    add("objects, how many", fmt::format("{}", result_.objects.size()), fmt::format("{}", objects.size()),
        result_.objects.size() == objects.size());
    for (std::size_t i = 0; i < std::min(objects.size(), result_.objects.size()); ++i) {
      const ReportedObject& reported = result_.objects[i];
      add(fmt::format("objects[{}].model", i),
          model_name(reported.model) + (reported.absent ? ", absent" : ""),
          model_name(objects[i].model) + (may_be_absent(objects[i]) ? ", or absent" : ""),
          scene_.kind(reported.model) == objects[i].model && (may_be_absent(objects[i]) || !reported.absent));
    }
    if (!result_.has_bound()) return;
    for (std::size_t model = 0; model < scene_.models.size(); ++model) {
      std::int64_t most = 0, least = 0;
      for (const SceneObject& object : objects)
        if (object.model == model) {
          ++most;
          least += !object.optional;
        }
      const auto placed = std::count_if(result_.search_objects.begin(), result_.search_objects.end(),
                                        [&](const PlacedModel& o) { return scene_.kind(o.model) == model; });
      if (most == 0 && placed == 0) continue;
      add(fmt::format("search_objects: {}", model_name(model)), fmt::format("{}", placed),
          least == most ? fmt::format("{}", most) : fmt::format("{} to {}", least, most),
          least <= placed && placed <= most);
    }
  }

  /// A method without a bound may have found no pose of an object.
  bool may_be_absent(const SceneObject& object) const { return object.optional || !result_.has_bound(); }
  const std::string& model_name(std::size_t model) const { return scene_.models[model].name; }

  const Scene& scene_;
  const ReportedResult& result_;
  Checks& checks_;
};

}  // namespace

void check_certificate(const Scene& scene, const ReportedResult& result, Checks& checks) {
  CertificateCheck(scene, result, checks).run();
}

}  // namespace perch
