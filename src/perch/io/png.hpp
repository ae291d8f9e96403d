#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "perch/core/image.hpp"
#include "perch/localize/scene.hpp"

namespace perch {

/// The width and height that a PNG's header states, pixels. Throws InputError for a file that is none.
struct PngSize {
  int width = 0, height = 0;
};
PngSize png_size(const std::filesystem::path& path);

/// The counts of a depth image: a 16-bit greyscale PNG of exactly width x height pixels. Throws InputError
/// (one line: file, what, remedy) for any other kind or size, a truncated or damaged file, or no PNG; the
/// size is looked at before memory is taken.
Image<std::uint16_t> read_png16_gray(const std::filesystem::path& path, int width, int height);

/// 1 where any colour channel of a PNG is non-zero, else 0; any kind of PNG, alpha doesn't count. Throws as
/// read_png16_gray.
Image<std::uint8_t> read_mask(const std::filesystem::path& path, int width, int height);

/// Any kind of PNG as 8-bit colour, alpha dropped. Throws as read_png16_gray.
Image<Rgb> read_color(const std::filesystem::path& path, int width, int height);

/// The bytes of a 16-bit greyscale PNG; the image must not be empty.
std::string encode_png16_gray(const Image<std::uint16_t>& image);

/// The bytes of an 8-bit greyscale PNG; the image must not be empty.
std::string encode_png8_gray(const Image<std::uint8_t>& image);

/// The bytes of an 8-bit RGB PNG; the image must not be empty.
std::string encode_png_color(const Image<Rgb>& image);

/// Writes a 16-bit greyscale PNG, whole or not at all. Throws InputError where it can't be written.
void write_png16_gray(const std::filesystem::path& path, const Image<std::uint16_t>& image);

/// Depth in metres of counts at `depth_scale` metres per count: the product in double, rounded to float once.
DepthImage depth_from_counts(const Image<std::uint16_t>& counts, double depth_scale);

/// The nearest count of each depth (metres) at `depth_scale` metres per count: 0 where there is no reading,
/// else 1 to 65535.
Image<std::uint16_t> counts_from_depth(const DepthImage& depth, double depth_scale);

}  // namespace perch
