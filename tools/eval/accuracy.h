// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// Returns whether KITTI's D1 counts a pixel with this error and true disparity in px: more than 3 px and more than 5 %
/// off. The factor of 20 keeps 5 % exact, which 0.05 is not in binary.
template <typename Number>
bool is_d1_outlier(Number error, Number truth) {
    return error > 3 && error * 20 > std::abs(truth);
}

/// Returns NaN where there is nothing to be a part of.
inline double percent_of(std::size_t part, std::size_t all) {
    return all == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : 100.0 * static_cast<double>(part) / static_cast<double>(all);
}

/// Percent of judged pixels. A pixel is judged where the truth is known; it is bad when it is rejected or when
/// |disparity - truth| is more than the limit. NaN where no pixel is judged.
struct Accuracy {
    double bad1_nonocc = 0;  ///< limit 1 px, pixels that both cameras see
    double bad1_all = 0;     ///< limit 1 px, all pixels with truth
    double bad2_nonocc = 0;
    double bad2_all = 0;
    double density = 0;  ///< pixels with truth that have a disparity
    /// KITTI's D1: off by more than 3 px and by more than 5 % of the true disparity, or rejected.
    double d1_nonocc = 0;
    double d1_all = 0;
    /// False obstacles: of the pixels with truth and a disparity, those that read nearer than they are, by more than
    /// 3 px and more than 5 % of the true disparity.
    double false_near = 0;
    /// Of the pixels on poles and wires, those that are not bad with a limit of 1 px.
    double thin_found = 0;
};

/// `non_occluded` has one value per pixel, 0 = occluded; empty: not known, the non-occluded figures are NaN. `thin` has
/// one value per pixel, 0 = no pole and no wire; empty: not known. Throws std::invalid_argument when the sizes differ.
Accuracy measure(const images::FloatMap& disparity, const images::FloatMap& truth,
                 const std::vector<std::uint8_t>& non_occluded, const std::vector<std::uint8_t>& thin = {});

}  // namespace disparityd::eval
