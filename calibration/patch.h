// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "calibration/corners.h"
#include "kernels/image.h"

namespace disparityd::calibration {

/// Patches are squares of 11 x 11 pixels around a centre.
inline constexpr int patch_radius = 5;
inline constexpr int patch_side = 2 * patch_radius + 1;
inline constexpr int patch_pixels = patch_side * patch_side;

/// What normalised correlation needs of a patch beside the products.
struct PatchSums {
    std::int64_t sum = 0;
    std::int64_t squares = 0;

    /// -1 .. 1; -1 where one of the two has no texture at all.
    double correlation(const PatchSums& other, std::int64_t products) const {
        const std::int64_t mine = patch_pixels * squares - sum * sum;
        const std::int64_t others = patch_pixels * other.squares - other.sum * other.sum;
        if (mine <= 0 || others <= 0) {
            return -1;
        }
        const std::int64_t common = patch_pixels * products - sum * other.sum;
        return static_cast<double>(common) / std::sqrt(static_cast<double>(mine) * static_cast<double>(others));
    }
};

/// The whole patch lies in the image.
PatchSums sums_of(Plane<const std::uint8_t> image, Pixel centre);

struct Place {
    double x = 0;
    double y = 0;
};

/// Where the left patch lies in the right image, near `start`, to a small part of a pixel: Gauss and Newton on the
/// difference of the patches, both freed of brightness and contrast, the right image interpolated by cubics. None when
/// that does not settle within 1.5 px or the patches are too unlike.
std::optional<Place> refine(Plane<const std::uint8_t> left, Pixel corner, Plane<const std::uint8_t> right, Pixel start);

}  // namespace disparityd::calibration
