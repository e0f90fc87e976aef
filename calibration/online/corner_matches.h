// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::calibration {

/// One point of the scene in both rectified images, in pixels.
struct CornerMatch {
    double left_x = 0;
    double left_y = 0;
    double right_x = 0;
    double right_y = 0;
};

/// Matches corners of the left image in the right one, up to `rows` rows above or below. A match has the best
/// normalised correlation of 11 x 11 pixels, is unambiguous, is confirmed from right to left, and is refined to
/// subpixels by least squares. There is at most one corner per square of about a fortieth of the width. Both images
/// have one size. Runs in the calling thread, with the same numbers on every machine. `give_up`, where there is one,
/// ends the search soon after it is set; the matches so far are returned.
std::vector<CornerMatch> match_corners(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                                       DisparityRange range, int rows, const std::atomic<bool>* give_up = nullptr);

}  // namespace disparityd::calibration
