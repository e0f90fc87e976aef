// SPDX-License-Identifier: Apache-2.0
#include "kernels/depth_error.h"

#include <algorithm>

#include "kernels/reference/steps.h"

namespace disparityd::reference {

void depth_error(Plane<const std::int16_t> disparity, Plane<const std::uint8_t> confidence,
                 const DepthErrorScale& scale, Plane<std::uint16_t> error, Rows rows) {
    for (int y = rows.first; y < rows.last; ++y) {
        for (int x = 0; x < disparity.width; ++x) {
            if (confidence.at(x, y) == 0 || !scale.known) {
                error.at(x, y) = 0;
                continue;
            }
            const std::int64_t n = std::min(disparity.at(x, y) + scale.offset16, max_error_disparity);
            const std::int64_t millimetres = n <= 0 ? 65535 : (scale.numerator + n * n / 2) / (n * n);
            error.at(x, y) = static_cast<std::uint16_t>(std::clamp<std::int64_t>(millimetres, 1, 65535));
        }
    }
}

}  // namespace disparityd::reference
