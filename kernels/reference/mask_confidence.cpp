// SPDX-License-Identifier: Apache-2.0
#include "kernels/reference/steps.h"

namespace disparityd::reference {

void mask_confidence(Plane<const std::int16_t> disparity, std::int16_t invalid, Plane<std::uint8_t> confidence,
                     Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < disparity.width; ++x) {
            if (disparity.at(x, y) == invalid) {
                confidence.at(x, y) = 0;
            }
        }
    }
}

}  // namespace disparityd::reference
