// SPDX-License-Identifier: Apache-2.0
#include "tools/images/disparity_map.h"

#include <limits>

namespace disparityd::images {

FloatMap to_float(const DisparityMap& map) {
    FloatMap result{map.d16.width, map.d16.height, {}};
    result.values.reserve(static_cast<std::size_t>(map.d16.width) * static_cast<std::size_t>(map.d16.height));
    for (int y = 0; y < map.d16.height; ++y) {
        for (int x = 0; x < map.d16.width; ++x) {
            const std::int16_t d16 = map.d16.at(x, y);
            result.values.push_back(d16 == map.invalid() ? std::numeric_limits<float>::infinity()
                                                         : static_cast<float>(d16) / 16.0F);
        }
    }
    return result;
}

double Metric::metres(double disparity) const {
    const double shift = disparity + disparity_offset;
    return known() && shift > 0 ? f * baseline_mm / shift / 1000.0 : std::numeric_limits<double>::infinity();
}

}  // namespace disparityd::images
