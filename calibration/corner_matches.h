// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::calibration {

/// A place of the room in both rectified images, in pixels.
struct CornerMatch {
    double left_x = 0;
    double left_y = 0;
    double right_x = 0;
    double right_y = 0;
};

/// Finds corners of the left image again in the right one, up to `rows` rows above or below: normalised correlation of
/// 11 x 11 pixels, unambiguous and confirmed from the right, then to a small part of a pixel by least squares. At most
/// one corner per square of about a fortieth of the width. Both images of one size; one thread, and the same numbers on
/// every machine. `give_up`, where there is one, ends the search soon after it is set; what was found so far is given.
std::vector<CornerMatch> match_corners(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right,
                                       DisparityRange range, int rows, const std::atomic<bool>* give_up = nullptr);

}  // namespace disparityd::calibration
