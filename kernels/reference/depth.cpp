// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

void depth(Plane<const std::int16_t> disparity, std::int16_t invalid, DepthScale scale, Plane<std::uint16_t> depth,
           Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < disparity.width; ++x) {
            const std::int16_t value = disparity.at(x, y);
            if (value == invalid || scale.k == 0) {
                depth.at(x, y) = 0;
                continue;
            }
            const std::int64_t d = std::int64_t{value} + scale.offset16;
            const std::int64_t millimetres = d <= 0 ? 65535 : (scale.k + d / 2) / d;
            depth.at(x, y) = static_cast<std::uint16_t>(std::clamp<std::int64_t>(millimetres, 1, 65535));
        }
    }
}

}  // namespace disparityd::reference
