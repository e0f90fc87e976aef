// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// What of step 13's depth error is the same for all pixels of a frame. C++17: the CUDA compiler reads this.
namespace disparityd {

/// From here on a disparity, with its offset and in 1/16 px, has the error of this one: its square fits into 30 bits.
constexpr std::int64_t max_error_disparity = 32767;

/// Depth error from disparity: E[mm] = (numerator + n^2 / 2) / n^2 with n = d16 + offset16.
struct DepthErrorScale {
    bool known = false;          ///< false: no metric calibration, every error is 0 (unknown)
    std::int64_t numerator = 0;  ///< K s / 16, rounded
    std::int64_t offset16 = 0;
};

/// Returns the scale for K and offset16 of a DepthScale. `subpixel_error`: one sigma of a disparity in 1/256 px, 1 ..
/// 1024. A K above 2^47, which no camera has, counts as 2^47.
constexpr DepthErrorScale depth_error_scale(std::int64_t k, int offset16, int subpixel_error) {
    constexpr std::int64_t max_k = std::int64_t{1} << 47;
    const std::int64_t limited = k < max_k ? k : max_k;
    return k > 0 ? DepthErrorScale{true, (limited * subpixel_error + 8) / 16, offset16} : DepthErrorScale{};
}

}  // namespace disparityd
