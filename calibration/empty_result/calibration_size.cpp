// SPDX-License-Identifier: Apache-2.0
#include "calibration/empty_result/calibration_size.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace disparityd::empty_result {

std::optional<double> size_of_calibration(const calibration::StereoCalibration& calibration) {
    if (calibration.left.fx == 0) {
        return std::nullopt;  // rectified images of which nothing else is known
    }
    // HD2K and HD1080 differ by 1.15. Rectification moves the principal point of images that are rectified already.
    const double least = calibration.rectified ? 1.35 : 1.1;
    const auto of_width = [&](double centre) { return 2 * centre / calibration.width; };
    const auto of_height = [&](double centre) { return 2 * centre / calibration.height; };
    const std::array<double, 4> ratios{of_width(calibration.left.cx), of_height(calibration.left.cy),
                                       of_width(calibration.right.cx), of_height(calibration.right.cy)};
    const auto [smallest, largest] = std::minmax_element(ratios.begin(), ratios.end());
    if (*smallest<least&& * largest> 1 / least) {
        return std::nullopt;
    }
    double product = 1;
    for (const double ratio : ratios) {
        product *= std::max(ratio, 1e-3);
    }
    return std::pow(product, 0.25);
}

}  // namespace disparityd::empty_result
