#include "perch/eval/visible_fractions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "perch/io/json_entry.hpp"

namespace perch {

std::vector<double> visible_fractions(const std::vector<DepthPatch>& alone) {
  std::vector<double> fractions;
  for (std::size_t i = 0; i < alone.size(); ++i) {
    const DepthPatch& patch = alone[i];
    std::int64_t covered = 0, seen = 0;
    for (int v = patch.window.v0; v < patch.window.v1; ++v)
      for (int u = patch.window.u0; u < patch.window.u1; ++u) {
        const float depth = patch.at(u, v);
        if (!(depth < no_surface)) continue;
        ++covered;
        bool hidden = false;
        for (std::size_t j = 0; j < alone.size() && !hidden; ++j) {
          const float other = alone[j].at_or_none(u, v);
          hidden = j < i ? other <= depth : j > i && other < depth;
        }
        seen += !hidden;
      }
    fractions.push_back(covered == 0 ? 0.0 : static_cast<double>(seen) / static_cast<double>(covered));
  }
  return fractions;
}

std::optional<std::vector<double>> read_visible_fractions(const std::filesystem::path& scene_file,
                                                          const Scene& scene) {
  const std::filesystem::path file = scene_file.parent_path() / "truth.json";
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return std::nullopt;
  const JsonEntry root = JsonEntry::read(file);
  if (!root.contains("visible")) return std::nullopt;
  const JsonEntry list = root["visible"];
  std::vector<double> fractions;
  for (const JsonEntry& entry : list.items()) {
    fractions.push_back(entry.number());
    if (!(fractions.back() >= 0.0 && fractions.back() <= 1.0))
      entry.fail(fmt::format("{} is not from 0 to 1; give the visible share of the object", entry.value()));
  }
  if (fractions.size() != scene.truth.size())
    list.fail(
        fmt::format("has {} entries, but the scene's truth has {} objects; give one for each, or leave out "
                    "the list: it is computed then",
                    fractions.size(), scene.truth.size()));
  return fractions;
}

}  // namespace perch
