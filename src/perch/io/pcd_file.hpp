#pragma once

#include <string_view>

#include "perch/io/point_cloud.hpp"

namespace perch {

/// The x, y and z of a PCD file (versions 0.5 to 0.7): ASCII, binary or binary_compressed, among any other
/// fields in any order. Throws FormatFault: a header that promises more than the file holds, points without
/// x, y and z as 4- or 8-byte floats, a VIEWPOINT that is no pose. No memory is taken for what a header
/// promises before the file is known to hold it.
/// Source: pointclouds.org, "The PCD (Point Cloud Data) file format".
PointCloud read_pcd(std::string_view bytes);

}  // namespace perch
