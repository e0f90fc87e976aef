// SPDX-License-Identifier: Apache-2.0
#include "tools/images/colour_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <opencv2/imgproc.hpp>

namespace disparityd::images {

const std::array<cv::Vec3b, 256>& colour_map() {
    static const std::array<cv::Vec3b, 256> map = [] {
        std::array<std::uint8_t, 256> numbers;
        std::iota(numbers.begin(), numbers.end(), std::uint8_t{0});
        std::array<cv::Vec3b, 256> colours;
        cv::Mat made(1, 256, CV_8UC3, colours.data());
        cv::applyColorMap(cv::Mat(1, 256, CV_8UC1, numbers.data()), made, cv::COLORMAP_TURBO);
        return colours;
    }();
    return map;
}

cv::Vec3b colour_of(double disparity, const ColourScale& scale) {
    const double t = (disparity - scale.low) / (scale.high - scale.low);
    return colour_map()[static_cast<std::size_t>(std::lround(std::clamp(t, 0.0, 1.0) * 255))];
}

}  // namespace disparityd::images
