#include "perch/io/bop_targets.hpp"

#include <fmt/format.h>

#include <map>

#include "perch/io/bop_json.hpp"

namespace perch {

std::vector<BopImageTargets> read_bop_targets(const std::filesystem::path& file) {
  constexpr std::int64_t most_copies = 1000;
  const JsonEntry root = read_bop_json(file);
  std::map<std::pair<int, int>, std::map<int, int>> images;
  for (const JsonEntry& entry : root.items()) {
    const int obj_id = bop_number(entry["obj_id"]);
    const std::pair image(bop_number(entry["scene_id"]), bop_number(entry["im_id"]));
    const std::int64_t count = entry["inst_count"].integer();
    if (count < 1 || count > most_copies)
      entry["inst_count"].fail(
          fmt::format("{} is no number of copies; give one from 1 to {}", count, most_copies));
    if (!images[image].emplace(obj_id, static_cast<int>(count)).second)
      entry.fail(fmt::format(
          "names model {} in image {} of scene {} a second time; give each once with its inst_count", obj_id,
          image.second, image.first));
  }
  if (images.empty()) root.fail("is empty; list at least one target");
  std::vector<BopImageTargets> out;
  for (const auto& [image, objects] : images)
    out.push_back({image.first, image.second, {objects.begin(), objects.end()}});
  return out;
}

}  // namespace perch
