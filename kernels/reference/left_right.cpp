// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

void left_right(Plane<const std::int16_t> left_winner, Plane<const std::int16_t> right_winner, DisparityRange range,
                Plane<std::int16_t> disparity, Rows rows) {
    const int width = disparity.width;
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < width; ++x) {
            const int d = left_winner.at(x, y);
            const int right_x = x - d;
            const bool agree = right_x >= 0 && right_x < width && right_winner.at(right_x, y) >= range.first &&
                               std::abs(right_winner.at(right_x, y) - d) <= 1;
            if (!agree) {
                disparity.at(x, y) = invalid_disparity(range);
            }
        }
    }
}

}  // namespace disparityd::reference
