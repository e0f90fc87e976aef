// SPDX-License-Identifier: Apache-2.0
#include "calibration/empty_result/texture_share.h"

#include <algorithm>
#include <cstdlib>

#include <opencv2/imgproc.hpp>

namespace disparityd::empty_result {
namespace {

constexpr int shrink = 4;
// A second difference: a ramp has none. Noise of 3 grey levels has a deviation of 4.5 in the reduced image.
constexpr int least_change = 18;

}  // namespace

double texture_share(Plane<const std::uint8_t> image) {
    const cv::Mat whole(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                        static_cast<std::size_t>(image.stride));
    const cv::Size size(std::max(image.width / shrink, 3), std::max(image.height / shrink, 3));
    cv::Mat reduced, change;
    cv::resize(whole, reduced, size, 0, 0, cv::INTER_AREA);
    cv::Sobel(reduced, change, CV_16S, 2, 0);
    change = change.colRange(1, change.cols - 1);  // a ramp has an edge at the border, which is mirrored
    const auto strong = std::count_if(change.begin<std::int16_t>(), change.end<std::int16_t>(),
                                      [](std::int16_t value) { return std::abs(value) >= least_change; });
    return static_cast<double>(strong) / static_cast<double>(change.total());
}

}  // namespace disparityd::empty_result
