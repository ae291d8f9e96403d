#include "perch/observation/point_blocks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "perch/core/instruction_set.hpp"

namespace perch {

PointBlocks::PointBlocks(const Observation& observation, double radius) : window_(observation.window()) {
  // A group of pixels that sees a surface from the front fills half of a ball; one that slants fills more.
  const Intrinsics& k = observation.intrinsics();
  const double footprint =
      0.5 * (static_cast<double>(observation.nearest()) + observation.farthest()) / std::max(k.fx, k.fy);
  pixels_ = std::clamp(static_cast<int>(radius / std::max(footprint, 1e-9)), 1, 64);
  columns_ = (k.width + pixels_ - 1) / pixels_;
  const int rows = (k.height + pixels_ - 1) / pixels_;
  const std::vector<Eigen::Vector3f>& points = observation.points();
  block_.resize(points.size());
  const float most = static_cast<float>(radius);

  struct Block {
    Eigen::AlignedBox3f box;
    std::vector<std::size_t> points;
  };
  std::vector<Block> blocks;
  std::vector<std::vector<std::size_t>> row_points(static_cast<std::size_t>(columns_));
  first_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows) + 1);
  first_.push_back(0);
  for (int row = 0; row < rows; ++row) {
    for (auto& of_cell : row_points) of_cell.clear();
    for (std::size_t i = observation.row_begin(row * pixels_);
         i < observation.row_begin(std::min(k.height, (row + 1) * pixels_)); ++i)
      row_points[static_cast<std::size_t>(observation.column(i) / pixels_)].push_back(i);
    for (const auto& of_cell : row_points) {
      blocks.clear();
      for (const std::size_t i : of_cell) {
        // The first block that has room; a jump in depth opens another.
        const auto has_room = [&](const Block& block) {
          Eigen::AlignedBox3f box = block.box;
          return 0.5F * box.extend(points[i]).diagonal().norm() <= 0.999F * most;
        };
        auto block = std::find_if(blocks.begin(), blocks.end(), has_room);
        if (block == blocks.end()) block = blocks.insert(block, Block());
        block->box.extend(points[i]);
        block->points.push_back(i);
      }
      for (const Block& block : blocks) {
        const Eigen::Vector3f centre = block.box.center();
        float reach = 0.0F;
        for (const std::size_t i : block.points) {
          reach = std::max(reach, (points[i] - centre).norm());
          block_[i] = static_cast<std::uint32_t>(x_.size());
        }
        x_.push_back(centre.x());
        y_.push_back(centre.y());
        z_.push_back(centre.z());
        radius_.push_back(reach);
      }
      first_.push_back(x_.size());
    }
  }
  size_ = x_.size();
  for (std::vector<float>* values : {&x_, &y_, &z_, &radius_}) values->resize(size_ + lane_count, 0.0F);
}

}  // namespace perch
