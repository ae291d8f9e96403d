#pragma once

#include <lzf.h>

#include <Eigen/Core>
#include <cmath>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"
#include "perch/core/random.hpp"
#include "perch/io/test_files.hpp"

namespace perch::testing_files {

using Points = std::vector<Eigen::Vector3d>;

/// The points that the pixels of a depth image show; a pixel without a reading has `missing`.
inline Points points_of(const DepthImage& depth, const Intrinsics& k, const Eigen::Vector3d& missing) {
  Points points;
  for (int v = 0; v < depth.height(); ++v)
    for (int u = 0; u < depth.width(); ++u) {
      const auto z = static_cast<double>(depth(u, v));
      points.push_back(z > 0.0 ? Eigen::Vector3d((u - k.cx) / k.fx * z, (v - k.cy) / k.fy * z, z) : missing);
    }
  return points;
}

enum class CloudEncoding { pcd_ascii, pcd_binary, pcd_compressed, ply_ascii, ply_little, ply_big };
inline const std::vector<CloudEncoding> all_cloud_encodings{
    CloudEncoding::pcd_ascii, CloudEncoding::pcd_binary, CloudEncoding::pcd_compressed,
    CloudEncoding::ply_ascii, CloudEncoding::ply_little, CloudEncoding::ply_big};

/// A cloud's file, its fields among others in an order drawn from the seed.
struct CloudWriter {
  CloudEncoding encoding = CloudEncoding::pcd_ascii;
  std::uint64_t seed = 0;
  bool doubles = false;  ///< x, y and z in 8 bytes, else in 4
  std::string viewpoint = "VIEWPOINT 0 0 0 1 0 0 0\n";

  bool is_pcd() const { return encoding <= CloudEncoding::pcd_compressed; }
  const char* ending() const { return is_pcd() ? ".pcd" : ".ply"; }

  /// \param height 1 for an unorganized cloud.
  std::string write(const Points& points, std::size_t width, std::size_t height) const {
    Random random(seed);
    // A field is x, y or z, or of 1 to 3 bytes that mean nothing.
    std::vector<std::pair<std::string, int>> fields{{"x", 0}, {"y", 0}, {"z", 0}, {"label", 1}};
    if (random.below(2)) fields.emplace_back("rgb", is_pcd() ? 3 : 1);
    for (std::size_t i = fields.size(); i > 1; --i) std::swap(fields[i - 1], fields[random.below(i)]);

    std::string sizes, types, counts, names, properties;
    for (const auto& [name, bytes] : fields) {
      names += " " + name;
      sizes += bytes ? " 1" : doubles ? " 8" : " 4";
      types += bytes ? " U" : " F";
      counts += fmt::format(" {}", std::max(1, bytes));
      properties += fmt::format("property {} {}\n", bytes ? "uchar" : doubles ? "double" : "float32", name);
    }
    const char* data = encoding == CloudEncoding::pcd_ascii    ? "ascii"
                       : encoding == CloudEncoding::pcd_binary ? "binary"
                                                               : "binary_compressed";
    const char* format = encoding == CloudEncoding::ply_ascii    ? "ascii"
                         : encoding == CloudEncoding::ply_little ? "binary_little_endian"
                                                                 : "binary_big_endian";
    std::string out =
        is_pcd() ? fmt::format(
                       "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\n"
                       "COUNT{}\nWIDTH {}\nHEIGHT {}\n{}POINTS {}\nDATA {}\n",
                       names, sizes, types, counts, width, height, viewpoint, points.size(), data)
                 : fmt::format(
                       "ply\nformat {} 1.0\nobj_info num_cols {}\nobj_info num_rows {}\nelement vertex {}\n"
                       "{}element camera 1\nproperty float view_px\nend_header\n",
                       format, width, height, points.size(), properties);

    const auto value = [&](double number) {
      if (encoding == CloudEncoding::ply_big) return doubles ? big(number) : big(static_cast<float>(number));
      return doubles ? little(number) : little(static_cast<float>(number));
    };
    const bool ascii = encoding == CloudEncoding::pcd_ascii || encoding == CloudEncoding::ply_ascii;
    std::vector<std::string> columns(fields.size());  // of a compressed file
    for (const Eigen::Vector3d& p : points) {
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const auto& [name, bytes] = fields[f];
        std::string field;
        if (bytes)
          for (int i = 0; i < bytes; ++i)
            field += ascii ? fmt::format("{} ", random.below(256))
                           : std::string(1, static_cast<char>(random.below(256)));
        else if (const double number = p[name[0] - 'x']; ascii)
          field = doubles ? fmt::format("{} ", number) : fmt::format("{} ", static_cast<float>(number));
        else
          field = value(number);
        (encoding == CloudEncoding::pcd_compressed ? columns[f] : out) += field;
      }
      if (ascii) out += '\n';
    }
    if (encoding == CloudEncoding::pcd_compressed) {
      std::string whole;
      for (const std::string& column : columns) whole += column;
      std::string packed(2 * whole.size() + 64, '\0');
      packed.resize(lzf_compress(whole.data(), static_cast<unsigned>(whole.size()), packed.data(),
                                 static_cast<unsigned>(packed.size())));
      out += little(static_cast<std::uint32_t>(packed.size())) +
             little(static_cast<std::uint32_t>(whole.size())) + packed;
    }
    if (encoding == CloudEncoding::ply_ascii) out += "0\n";
    if (encoding == CloudEncoding::ply_little || encoding == CloudEncoding::ply_big)
      out += std::string(4, '\0');
    return out;
  }
};

}  // namespace perch::testing_files
