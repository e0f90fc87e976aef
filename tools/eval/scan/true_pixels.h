// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/scan_counts.h"
#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// What a perfect matcher would give: the true disparity, sure where it is known. Owns the planes.
class TruePixels {
public:
    /// Gaps of up to `most_gap` px in a row, then in a column, between two known pixels get the farther one of the two:
    /// a scan takes a pixel without disparity for one that may hide something, while laser points have gaps everywhere.
    TruePixels(const images::FloatMap& truth, int most_gap);

    scan::Pixels pixels() const;

private:
    int width_;
    int height_;
    std::vector<std::int16_t> disparity_;
    std::vector<std::uint8_t> confidence_;
};

}  // namespace disparityd::eval
