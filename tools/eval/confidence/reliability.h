// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tools/images/disparity_map.h"

namespace disparityd::eval {

/// How often pixels of each confidence are right. A pixel counts when its truth is known and its confidence is not 0;
/// it is right when |disparity - truth| is at most 1 px. Each scene that was added has a weight of 1, whatever its
/// size.
struct Reliability {
    std::array<double, 256> weight{};  ///< of the pixels with this confidence
    std::array<double, 256> right{};   ///< of those that are right

    /// Adds a scene; one without a pixel that counts adds nothing. Throws std::invalid_argument when the sizes differ.
    void add(const images::FloatMap& disparity, const std::vector<std::uint8_t>& confidence,
             const images::FloatMap& truth);
    void add(const Reliability& other);
};

/// Pixels whose confidence lies in a range. Shares are 0 to 1, NaN where there is no such pixel.
struct ReliabilityBin {
    int first = 0;
    int last = 0;
    double share = 0;  ///< of all pixels that count
    double says = 0;   ///< mean of confidence / 255
    double is = 0;     ///< share of right pixels
};

/// Returns 16 bins: confidences 1 to 15, 16 to 31, ... 240 to 255.
std::vector<ReliabilityBin> reliability_bins(const Reliability& counted);

/// The mean of |says - is| over the bins, each with the weight of its share (expected calibration error). 0 to 1; NaN
/// without pixels.
double calibration_error(const Reliability& counted);

/// What is lost by ordering pixels by confidence instead of by their true error: the share of wrong pixels among those
/// that are left after the least confident ones were removed, less the same with the wrong ones removed first, averaged
/// over the removed share from 0 to 1 (area under the sparsification error). 0 is the best; NaN without pixels.
double sparsification_area(const Reliability& counted);

}  // namespace disparityd::eval
