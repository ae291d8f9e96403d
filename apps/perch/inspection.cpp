#include "inspection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "camera_check.hpp"
#include "perch/candidates/candidate_maker.hpp"
#include "perch/candidates/grid.hpp"
#include "perch/core/stopwatch.hpp"
#include "perch/localize/localize.hpp"
#include "perch/localize/setup.hpp"
#include "perch/localize/symmetry_search.hpp"
#include "perch/observation/extent.hpp"

namespace perch::app {
namespace {

bool is_of_interest(const Scene& scene, int u, int v) {
  return scene.depth(u, v) > 0.0F && (!scene.mask || (*scene.mask)(u, v) != 0);
}

/// The longest side of the box around each connected part of I; neighbours are connected whose depths differ
/// by less than a hundredth. Camera frame, metres.
double largest_blob(const Scene& scene) {
  constexpr float step = 0.01F;
  constexpr std::size_t least = 30;  // pixels; smaller ones are noise
  const RaySlopes rays(scene.camera.intrinsics);
  Image<std::uint8_t> met(scene.depth.width(), scene.depth.height(), 0);
  double largest = 0.0;
  for (int v0 = 0; v0 < met.height(); ++v0)
    for (int u0 = 0; u0 < met.width(); ++u0) {
      if (met(u0, v0) || !is_of_interest(scene, u0, v0)) continue;
      Eigen::AlignedBox3f box;
      std::vector<std::pair<int, int>> open{{u0, v0}};
      met(u0, v0) = 1;
      std::size_t pixels = 0;
      while (!open.empty()) {
        const auto [u, v] = open.back();
        open.pop_back();
        ++pixels;
        const float z = scene.depth(u, v);
        box.extend(rays.point(u, v, z));
        for (const auto& [du, dv] : {std::pair(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
          const int x = u + du, y = v + dv;
          if (!met.contains(x, y) || met(x, y) || !is_of_interest(scene, x, y)) continue;
          if (std::abs(scene.depth(x, y) - z) > step * z) continue;
          met(x, y) = 1;
          open.emplace_back(x, y);
        }
      }
      if (pixels >= least) largest = std::max(largest, double{box.sizes().norm()});
    }
  return largest;
}

DepthFacts depth_facts(const Scene& raw, const Scene& observed) {
  DepthFacts facts;
  std::vector<float> depths;
  for (const float z : raw.depth.data())
    if (z > 0.0F) depths.push_back(z);
  std::sort(depths.begin(), depths.end());
  const auto pixels = static_cast<double>(raw.depth.size());
  facts.readings = static_cast<double>(depths.size()) / pixels;
  const auto hundredth = [&](double share) {
    return depths.empty()
               ? 0.0
               : double{depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))]};
  };
  facts.low = hundredth(0.01);
  facts.median = hundredth(0.5);
  facts.high = hundredth(0.99);
  const Intrinsics& k = raw.camera.intrinsics;
  for (int v = 0; v < k.height; ++v)
    for (int u = 0; u < k.width; ++u)
      if (is_of_interest(observed, u, v)) {
        ++facts.points;
        facts.area += std::pow(double{observed.depth(u, v)}, 2) / (k.fx * k.fy);
      }
  facts.observed = static_cast<double>(facts.points) / pixels;
  facts.largest_blob = largest_blob(observed);
  return facts;
}

/// How long localizing takes, about: a few hypotheses are refined and valued, the others take as long.
std::optional<double> expected_seconds(const Scene& ready, const Settings& settings, const Executor& executor,
                                       std::int64_t poses) {
  constexpr int samples = 48;
  const Stopwatch watch;
  const auto problem = make_problem(ready, settings, executor);
  const double preparing = watch.seconds();
  const Stopwatch trying;
  CandidateMaker maker(*problem);
  int tried = 0;
  for (std::size_t model = 0; model < problem->models().size(); ++model) {
    const auto n = static_cast<std::int64_t>(problem->grid(model).size());
    for (int i = 0; i < samples; ++i, ++tried)
      maker.refined(model, problem->grid(model).pose(n * i / samples));
  }
  const double each = trying.seconds() / std::max(1, tried);
  // Of what is refined a tenth is rendered; the bound and the polish take as long again.
  return preparing + 2.0 * each * static_cast<double>(poses) / static_cast<double>(executor.workers());
}

class Inspector {
 public:
  Inspector(const Scene& raw, const std::optional<Scene>& ready, const std::string& fault,
            const Settings& settings, const Executor& executor)
      : raw_(raw),
        scene_(ready ? *ready : raw),
        is_ready_(ready),
        fault_(fault),
        settings_(settings),
        executor_(executor) {}

  Inspection run() {
    found_.depth = depth_facts(raw_, scene_);
    // Without points there is nothing to search.
    is_ready_ = is_ready_ && found_.depth.points > 0;
    find_plane();
    if (auto warning = check_camera(raw_, found_.plane)) found_.warnings.push_back(std::move(*warning));
    // What a wrong camera pose leads to is no warning of its own.
    if (!fault_.empty() && !camera_is_off()) warn("", fault_, "");
    check_depth();
    check_delta();
    check_table();
    for (std::size_t i = 0; i < scene_.models.size(); ++i) inspect_model(i);
    count_poses();
    return std::move(found_);
  }

 private:
  void warn(const std::string& key, const std::string& what, const std::string& remedy) {
    found_.warnings.push_back({key, what, remedy});
  }

  void find_plane() {
    // Where the background was removed from the depth image itself, no plane can be trusted to be the table.
    if (raw_.background == Background::table || raw_.mask) {
      const double factor = factor_to_tables();
      // One that was taken from the camera pose for want of another has no readings.
      if (scene_.support && scene_.support->plane.readings > 0 && factor == 1.0)
        found_.plane = scene_.support->plane;
      else
        found_.plane = any_plane(factor);
    }
    if (is_ready_) found_.table_height = table_height(scene_);
    if (!found_.plane || !scene_.has_camera_pose) return;
    const Eigen::Vector3d up = scene_.camera.world_from_camera.linear() * found_.plane->normal;
    found_.plane_tilt = std::acos(std::clamp(up.z(), -1.0, 1.0));
    // Below the optical axis, where it meets the plane; where it doesn't, below the camera.
    const Eigen::Vector3d& normal = found_.plane->normal;
    const Eigen::Vector3d below = normal.z() < -0.05
                                      ? Eigen::Vector3d(0.0, 0.0, -found_.plane->distance / normal.z())
                                      : Eigen::Vector3d(-found_.plane->distance * normal);
    found_.plane_height = (scene_.camera.world_from_camera * below).z();
  }

  /// The power of ten that brings the readings to where tables are; 1 where they are there.
  double factor_to_tables() const {
    const double median = found_.depth.median;
    if (median <= 0.0 || (median > 0.15 && median < 4.0)) return 1.0;
    return std::pow(10.0, -std::round(std::log10(median)));
  }

  /// The support plane by the readings alone, whatever the camera pose says; looked for among depths that are
  /// `factor` times as large, for noise and sizes don't grow alike.
  std::optional<SupportPlane> any_plane(double factor) const {
    DepthImage depth = raw_.depth;
    for (std::size_t i = 0; i < depth.size(); ++i) depth[i] *= static_cast<float>(factor);
    auto plane = find_support_plane(depth, raw_.camera.intrinsics, {});
    if (!plane) return std::nullopt;
    plane->distance /= factor;
    plane->rms /= factor;
    plane->area /= factor * factor;
    return plane;
  }

  void check_depth() {
    const DepthFacts& d = found_.depth;
    if (d.readings == 0.0)
      return warn("observation.depth", "holds no reading", "check the file and the camera");
    if (d.readings < 0.4 && !raw_.mask && raw_.background == Background::table)
      warn("observation.depth", fmt::format("has readings at {:.0f} % of its pixels only", 100 * d.readings),
           "check distance, light and exposure; cost.missing_depth=ignore helps where surfaces are dark or "
           "shiny");
    const bool told = std::any_of(found_.warnings.begin(), found_.warnings.end(),
                                  [](const Warning& w) { return w.key == "observation.depth_scale"; });
    if (!told && (d.median > 12.0 || d.median < 0.08)) {
      const double factor = std::pow(10.0, std::round(std::log10(d.median)));
      warn(
          "observation.depth_scale",
          fmt::format("puts half of the readings {} {:.3g} m", d.median > 1 ? "beyond" : "nearer than",
                      d.median),
          fmt::format("is it {:g}? millimetres are 0.001, tenths of them 0.0001", raw_.depth_scale / factor));
    }
    if (!told && raw_.depth_scale > 0.5 * settings_.candidates.cost.delta)
      warn("observation.depth_scale",
           fmt::format("makes steps of {:g} m, coarser than half of delta ({:g} m)", raw_.depth_scale,
                       settings_.candidates.cost.delta),
           "check it, or use a larger --delta");
    if (raw_.mask && d.observed > 0.6)
      warn("observation.mask", fmt::format("marks {:.0f} % of the image as objects", 100 * d.observed),
           "is it inverted? non-zero means object");
    if (d.points < 200 && !camera_is_off() && fault_.empty())
      warn("observation", fmt::format("leaves {} points of the objects", d.points),
           "check mask, workspace and table.height");
  }

  void check_delta() {
    constexpr double scatter = 0.4;  // of delta: what lies farther off is no longer explained
    const double delta = settings_.candidates.cost.delta;
    if (found_.plane && !camera_is_off() && found_.plane->rms > scatter * delta)
      warn("delta",
           fmt::format("is {:g} m, but the readings of the table scatter by {:.1f} mm (rms)", delta,
                       1000 * found_.plane->rms),
           fmt::format("--delta {:g} leaves room for what the sensor gets wrong",
                       0.005 * std::ceil(found_.plane->rms / scatter / 0.005)));
  }

  void check_table() {
    if (!is_ready_ || !raw_.has_camera_pose || camera_is_off()) return;
    if (!raw_.table_height) return;
    // A plane is seen as it is; of objects the lowest part is often hidden, but nothing of them lies lower.
    const bool by_plane = found_.plane_height.has_value();
    const double seen =
        by_plane ? *found_.plane_height
                 : lowest_height(Observation(scene_.camera, scene_.depth, scene_.mask)) - least_base();
    const double above = seen - *raw_.table_height;
    const double most_above = by_plane ? 0.01 : 0.04, most_below = by_plane ? 0.01 : 0.015;
    if (above > most_above || above < -most_below)
      warn("table.height",
           fmt::format("is {:g} m, but {} at {:.3f} m", *raw_.table_height,
                       by_plane ? "the table is seen" : "the objects' lowest points lie", seen),
           fmt::format("use {:.3f}, or leave it out to have it estimated", seen));
  }

  double least_base() const {
    double least = scene_.models.front().base;
    for (const SceneObject& object : scene_.objects)
      least = std::min(least, scene_.models[object.model].base);
    return least;
  }

  bool camera_is_off() const {
    return std::any_of(found_.warnings.begin(), found_.warnings.end(), [](const Warning& w) {
      return w.key == "camera.world_from_camera" || w.key == "observation.depth_scale";
    });
  }

  void inspect_model(std::size_t i) {
    const SceneModel& model = scene_.models[i];
    const Eigen::AlignedBox3d box = model.mesh.bounds().cast<double>();
    ModelFacts facts;
    facts.name = model.name;
    facts.size = box.sizes();
    facts.origin = -box.center().head<2>() + Eigen::Vector2d::Zero();
    facts.triangles = model.mesh.triangles.size();
    facts.closed = is_closed(model.mesh);
    facts.stated = model.symmetry;
    const FoundSymmetry symmetry = find_symmetry(model.mesh, settings_.candidates.cost.delta);
    facts.found = symmetry.symmetry;
    const std::string key = "models." + model.name;
    const Eigen::Vector2d reach = 0.5 * box.sizes().head<2>();
    if ((facts.origin.cwiseAbs() - reach).maxCoeff() > 0.0)
      warn(key + ".mesh",
           fmt::format("has its origin beside it, {:.3f} m from its middle", facts.origin.norm()),
           "poses then refer to a point outside; move the mesh over its origin");
    if (!facts.closed)
      warn(key + ".mesh", "is not watertight", "collisions with it can't be seen; close its holes");
    if (symmetry.better_axis && symmetry.better_axis->at.norm() > settings_.candidates.cost.delta)
      warn(key + ".mesh",
           fmt::format("has its origin {:.1f} mm off an axis of symmetry ({})",
                       1000 * symmetry.better_axis->at.norm(), symmetry.better_axis->symmetry.name()),
           "move the mesh so that the axis is its z axis, and set symmetry: auto");
    if (facts.found.is_continuous() && !facts.stated.is_continuous())
      warn(key + ".symmetry", fmt::format("is {}, but all sides look the same", facts.stated.name()),
           "set symmetry: continuous, or auto: one yaw is enough then");
    std::vector<double> sides{facts.size.x(), facts.size.y(), facts.size.z()};
    std::sort(sides.begin(), sides.end());
    if (found_.depth.largest_blob > 0.0 && !camera_is_off() && sides[1] > 1.2 * found_.depth.largest_blob)
      warn(key,
           fmt::format("is {:.3f} x {:.3f} x {:.3f} m, larger than anything observed ({:.3f} m across)",
                       facts.size.x(), facts.size.y(), facts.size.z(), found_.depth.largest_blob),
           "check its unit and scale, and observation.depth_scale");
    if (sides[2] < 4.0 * settings_.candidates.cost.delta)
      warn(key, fmt::format("is {:.4f} m across, hardly more than delta", sides[2]),
           "check its unit (m or mm)");
    found_.models.push_back(facts);
  }

  void count_poses() {
    if (!is_ready_) return;
    const Observation observation(scene_.camera, scene_.depth, scene_.mask);
    const Eigen::AlignedBox2d seen = footprint(observation);
    for (std::size_t i = 0; i < scene_.models.size(); ++i) {
      double r = 0.0;
      for (const Eigen::Vector3f& p : scene_.models[i].mesh.vertices)
        r = std::max(r, double{p.head<2>().norm()});
      const Workspace w = scene_.workspace.value_or(
          Workspace{seen.min().x() - r, seen.max().x() + r, seen.min().y() - r, seen.max().y() + r});
      found_.models[i].grid_poses = static_cast<std::int64_t>(
          std::min(1e15, PoseGrid(w, settings_.candidates.grid, scene_.models[i].symmetry).size()));
      found_.grid_poses += found_.models[i].grid_poses;
    }
    if (found_.grid_poses > settings_.candidates.grid.max_poses)
      return warn("workspace",
                  fmt::format("takes {} grid poses, more than grid.max_poses ({})", found_.grid_poses,
                              settings_.candidates.grid.max_poses),
                  "use a smaller workspace or a coarser --resolution");
    found_.seconds = expected_seconds(scene_, settings_, executor_, found_.grid_poses);
    if (*found_.seconds > settings_.time_limit)
      warn("workspace",
           fmt::format("takes {} grid poses and about {:.0f} s, longer than --time-limit ({:g} s)",
                       found_.grid_poses, *found_.seconds, settings_.time_limit),
           "use a smaller workspace, a coarser --resolution or more time");
  }

  const Scene& raw_;
  const Scene& scene_;
  bool is_ready_;
  const std::string& fault_;
  const Settings& settings_;
  const Executor& executor_;
  Inspection found_;
};

}  // namespace

Inspection inspect(const Scene& raw, const std::optional<Scene>& ready, const std::string& fault,
                   const Settings& settings, const Executor& executor) {
  return Inspector(raw, ready, fault, settings, executor).run();
}

}  // namespace perch::app
