// SPDX-License-Identifier: Apache-2.0
#include "kernels/calibrated_confidence.h"
#include "kernels/reference/steps.h"

namespace disparityd::reference {

void finish_confidence(Plane<const std::int16_t> disparity, std::int16_t invalid, bool calibrated,
                       Plane<std::uint8_t> confidence, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < disparity.width; ++x) {
            std::uint8_t& of_pixel = confidence.at(x, y);
            if (disparity.at(x, y) == invalid) {
                of_pixel = 0;
            } else if (calibrated) {
                of_pixel = calibrated_confidence(of_pixel);
            }
        }
    }
}

}  // namespace disparityd::reference
