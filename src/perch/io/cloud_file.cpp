#include "perch/io/cloud_file.hpp"

#include <fmt/format.h>

#include <charconv>

#include "perch/core/error.hpp"
#include "perch/io/message.hpp"
#include "perch/io/pcd_file.hpp"
#include "perch/io/ply_elements.hpp"
#include "perch/io/read_file.hpp"
#include "perch/io/text_values.hpp"

namespace perch {
namespace {

constexpr std::uintmax_t largest_cloud_file = std::uintmax_t{2} << 30;

/// The vertices. An organized cloud is told by the notes `obj_info num_cols` and `num_rows`; where only
/// pixels with a reading have a vertex, a `range_grid` names the vertex of each pixel (none: no reading).
class CloudVisitor final : public PlyVisitor {
 public:
  void header(const PlyHeader& header) override {
    for (const std::string& note : header.notes) {
      std::string_view rest = note;
      const std::string_view key = next_word(rest).value_or(""), word = next_word(rest).value_or("");
      std::uint64_t value = 0;
      if (std::from_chars(word.data(), word.data() + word.size(), value).ec != std::errc{}) continue;
      if (key == "num_cols") columns_ = value;
      if (key == "num_rows") rows_ = value;
    }
  }

  void list(const PlyElement& element, const PlyProperty& property, std::uint64_t,
            std::span<const double> values) override {
    if (element.name != "range_grid" || property.name != "vertex_indices") return;
    vertex_of_pixel_.push_back(values.empty() ? -1.0 : values[0]);
  }

  void instance(const PlyElement& element, std::uint64_t, std::span<const double> values) override {
    if (element.name == "vertex") points_.push_back(ply_point(element, values));
  }

  PointCloud cloud() {
    PointCloud out;
    if (vertex_of_pixel_.empty()) {
      out.points = std::move(points_);
    } else {
      for (const double vertex : vertex_of_pixel_) {
        if (!(vertex < static_cast<double>(points_.size())))
          throw FormatFault{
              fmt::format("has a range_grid that names vertex {} of {}", vertex, points_.size())};
        out.points.push_back(vertex < 0.0 ? Eigen::Vector3d::Zero()
                                          : points_[static_cast<std::size_t>(vertex)]);
      }
    }
    // One row is no grid; and some programs drop points but keep the notes.
    if (rows_ > 1 && columns_ > 0 && out.points.size() % columns_ == 0 &&
        out.points.size() / columns_ == rows_)
      out.grid = {{columns_, rows_}};
    return out;
  }

 private:
  std::uint64_t columns_ = 0, rows_ = 0;
  std::vector<double> vertex_of_pixel_;
  std::vector<Eigen::Vector3d> points_;
};

PointCloud read_ply_cloud(std::string_view bytes) {
  CloudVisitor visitor;
  read_ply_elements(bytes, visitor);
  return visitor.cloud();
}

}  // namespace

PointCloud read_cloud(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  check_file(path, largest_cloud_file);
  if (ending != ".pcd" && ending != ".ply")
    throw InputError(fmt::format("{}: unknown cloud format \"{}\"; give a .pcd or .ply file", shown(path),
                                 one_line(path.extension().string())));
  const std::string bytes = read_file(path, largest_cloud_file);
  try {
    return ending == ".pcd" ? read_pcd(bytes) : read_ply_cloud(bytes);
  } catch (const FormatFault& fault) {
    throw InputError(fmt::format("{}: {}; write the cloud again", shown(path), fault.what));
  }
}

}  // namespace perch
