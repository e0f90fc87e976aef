// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/image.h"
#include "kernels/matcher.h"

namespace disparityd::images {

/// A matcher's result: disparity in 1/16 px and the range it was searched in. A view, it owns nothing.
struct DisparityMap {
    Plane<const std::int16_t> d16;
    DisparityRange range;

    std::int16_t invalid() const { return invalid_disparity(range); }
};

/// What a disparity file holds: pixels, row-major; a rejected or unknown one is +infinity.
struct FloatMap {
    int width = 0;
    int height = 0;
    std::vector<float> values;

    float at(int x, int y) const {
        return values[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
};

FloatMap to_float(const DisparityMap& map);

/// What turns a disparity into a distance: Z = f B / (d + offset). f in px, B in mm; 0 = not known.
struct Metric {
    double f = 0;
    double baseline_mm = 0;
    double disparity_offset = 0;

    bool known() const { return f > 0 && baseline_mm > 0; }
    /// Distance in metres; +infinity where it has no meaning (d + offset <= 0, or nothing known).
    double metres(double disparity) const;
};

}  // namespace disparityd::images
