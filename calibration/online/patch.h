// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "calibration/board/corners.h"
#include "kernels/image.h"

namespace disparityd::calibration {

/// Patches are squares of 11 x 11 pixels around a centre.
inline constexpr int patch_radius = 5;
inline constexpr int patch_side = 2 * patch_radius + 1;
inline constexpr int patch_pixels = patch_side * patch_side;

/// The sums of a patch that normalised correlation needs, beside the products.
struct PatchSums {
    std::int64_t sum = 0;
    std::int64_t squares = 0;

    /// Returns the correlation, -1 .. 1; -1 where one of the patches has no texture.
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

/// Sums up the patch around `centre`, which lies in the image as a whole.
PatchSums sums_of(Plane<const std::uint8_t> image, Pixel centre);

struct Place {
    double x = 0;
    double y = 0;
};

/// Finds the subpixel position of the left patch in the right image near `start`: Gauss-Newton on the difference of the
/// patches, normalised in brightness and contrast, with cubic interpolation of the right image. Returns nothing when
/// the iteration does not converge within 1.5 px or the patches differ too much.
std::optional<Place> refine(Plane<const std::uint8_t> left, Pixel corner, Plane<const std::uint8_t> right, Pixel start);

}  // namespace disparityd::calibration
