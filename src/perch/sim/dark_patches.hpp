#pragma once

#include <cstdint>

#include "perch/core/camera.hpp"
#include "perch/core/image.hpp"

namespace perch {

/// Where surfaces are too dark or too shiny to be read: patches fixed to the surfaces, of a given size, which
/// the same seed puts at the same places; those of a smaller share lie within those of a larger one. A
/// surface is dark where a Gaussian random field over space (covariance exp(-r^2 / 2 l^2), by random Fourier
/// features, Rahimi and Recht, NIPS 2007) is high.
///
/// \param may_be 0 at pixels that stay as they are. \param share of the other pixels with a depth that turn
/// dark, in [0, 1]; to half a pixel. \param size the mean length of a straight line's parts in dark where
/// half of the surface is, metres: pi l (Rice, 1944). Returns 1 where it is dark.
Image<std::uint8_t> dark_patches(const DepthImage& ideal, const Intrinsics& intrinsics,
                                 const Image<std::uint16_t>& may_be, double share, double size,
                                 std::uint64_t seed);

}  // namespace perch
