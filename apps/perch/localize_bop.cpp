#include "localize_bop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "bop_errors.hpp"
#include "command.hpp"
#include "localize.hpp"
#include "output.hpp"
#include "perch/io/atomic_write.hpp"
#include "perch/io/bop_results.hpp"
#include "perch/localize/prepare.hpp"

namespace perch::app {
namespace {

namespace fs = std::filesystem;

Scene prepared(Scene scene, const Settings& settings, const Executor& executor) {
  const std::string name = scene.name;
  scene = blaming(name, [&] { return prepare(std::move(scene), settings, executor); });
  if (!scene.has_camera_pose)
    throw InputError(fmt::format("{}: where the camera stands is not known; give --camera-pose", name));
  return scene;
}

void append_rows(const BopImage& image, const Result& result, double seconds,
                 std::vector<BopEstimate>& rows) {
  for (std::size_t i = 0; i < result.objects.size(); ++i) {
    const ObjectResult& object = result.objects[i];
    if (object.absent) continue;
    rows.push_back({image.scene_id, image.im_id, image.obj_ids[image.scene.objects[i].model],
                    object.confidence.value_or(0.0), object.camera_from_model, seconds});
  }
}

}  // namespace

void BopLocalization::add_to(CLI::App& command) {
  command.add_option("--bop", folder_, "data set in BOP layout, in place of scene files")
      ->group("BOP data sets");
  const auto option = [&](const char* flag, auto& value, const char* help) {
    command.add_option(flag, value, help)->group("BOP data sets");
  };
  option("--split", options_.split, "its folder of images [test]");
  option("--scene", scene_, "number of the scene");
  option("--image", image_, "number of the image in that scene");
  option("--targets", targets_, "list of images and objects, e.g. test_targets_bop19.json");
  option("--models", options_.models,
         "its folder of models [the first there is of models, models_eval, models_cad]");
  const auto flag = [&](const char* name, bool& value, const char* help) {
    command.add_flag(name, value, help)->group("BOP data sets");
  };
  flag("--masks", options_.masks, "what belongs to objects is given by mask_visib");
  flag("--upright", options_.upright,
       "models stand as in their files, not in any pose in which they may rest");
  flag("--camera-pose", options_.camera_pose,
       "the camera's pose is given by cam_R_w2c and cam_t_w2c, with z up; else it is found from the support "
       "plane");
}

void BopLocalization::check() const {
  const BopOptions defaults;
  const auto need = [&](const char* flag, bool used) {
    if (used) throw InputError(fmt::format("{} is about data sets; give one with --bop", flag));
  };
  if (given()) return;
  need("--split", options_.split != defaults.split);
  need("--scene", scene_.has_value());
  need("--image", image_.has_value());
  need("--targets", targets_.has_value());
  need("--models", !options_.models.empty());
  need("--masks", options_.masks);
  need("--upright", options_.upright);
  need("--camera-pose", options_.camera_pose);
}

std::vector<BopImageTargets> BopLocalization::images(BopDataset& dataset) const {
  if (scene_.has_value() != image_.has_value())
    throw InputError("--scene and --image belong together; give both, or --targets alone");
  if (!scene_ && !targets_)
    throw InputError("--bop: say which images: give --scene and --image, or --targets");
  if (scene_ && (*scene_ < 0 || *image_ < 0 || *scene_ > 999'999 || *image_ > 999'999))
    throw InputError(fmt::format("--scene {} --image {}: give numbers from 0 to 999999", *scene_, *image_));
  if (!targets_) return {dataset.annotated_objects(*scene_, *image_)};
  // Mostly named as it is called in the data set's folder.
  std::error_code ignored;
  const fs::path within = fs::path(folder_) / *targets_;
  const fs::path file =
      fs::exists(*targets_, ignored) || !fs::exists(within, ignored) ? fs::path(*targets_) : within;
  std::vector<BopImageTargets> all = read_bop_targets(file);
  if (!scene_) return all;
  const auto found = std::find_if(all.begin(), all.end(), [&](const BopImageTargets& image) {
    return image.scene_id == *scene_ && image.im_id == *image_;
  });
  if (found == all.end())
    throw InputError(
        fmt::format("{}: has no target in image {} of scene {}; leave out --targets, or give an image of it",
                    shown(file), *image_, *scene_));
  return {*found};
}

int localize_bop(const BopLocalization& bop, const Settings& settings, const Executor& executor,
                 const std::string& output, bool quiet, const Stopwatch& watch) {
  BopDataset dataset(bop.folder(), bop.options());
  const std::vector<BopImageTargets> images = bop.images(dataset);
  const std::size_t n = images.size();
  const std::string results_name =
      bop_results_name(name(settings.localization), dataset.name(), bop.options().split);
  const auto output_of = [&](const BopImage& image) {
    return n > 1 ? fs::path(output) / image.scene.name : fs::path(output);
  };
  // A broken one, or a place that can't be written to, is refused before any is worked on and written.
  for (const BopImageTargets& targets : images) {
    const BopImage image = dataset.image(targets);
    if (!output.empty()) rehearse_outputs(output_of(image));
  }
  OutputSet results;
  results.add(results_name, "");
  if (!output.empty()) results.rehearse(output);

  int status = exit_solved;
  std::vector<BopEstimate> rows;
  BopErrors errors;
  for (std::size_t i = 0; i < n; ++i) {
    const Stopwatch of_image;
    // Each image gets its share of what is left of the command's time.
    const StopCondition stop =
        StopCondition::after((settings.time_limit - watch.seconds()) / static_cast<double>(n - i));
    try {
      BopImage image = dataset.image(images[i]);
      image.scene = prepared(std::move(image.scene), settings, executor);
      const auto residuals = set_bop_truth(dataset, image.truth, image.scene);
      const Scene& scene = image.scene;
      const Result result = localize_with_progress(scene, settings, executor, stop, quiet, scene.name);
      append_rows(image, result, of_image.seconds(), rows);
      if (!output.empty()) write_outputs(scene, result, settings, executor, output_of(image));
      if (!quiet) print_table(scene, result);
      errors.add(dataset, image, result, residuals, !quiet);
      if (result.status == Status::infeasible)
        fmt::print(stderr, "perch: {}: no solution: {}\n", scene.name, result.reason);
      status = std::max(status, exit_status(result.status));
    } catch (const InputError& e) {
      // One image without a plane is no reason to throw away a night's work on the others.
      if (n == 1) throw;
      fmt::print(stderr, "perch: {}\n", e.what());
      status = std::max<int>(status, exit_bad_input);
    }
  }
  if (!output.empty()) write_atomically(fs::path(output) / results_name, bop_results_csv(rows));
  if (!quiet) errors.print();
  return status;
}

}  // namespace perch::app
