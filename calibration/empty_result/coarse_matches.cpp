// SPDX-License-Identifier: Apache-2.0
#include "calibration/empty_result/coarse_matches.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "calibration/online/corner_matches.h"

namespace disparityd::empty_result {
namespace {

constexpr int reduced_width = 340;
constexpr int rows_searched = 16;  // of the reduced image

cv::Mat shrunk(Plane<const std::uint8_t> image, int reduction) {
    const cv::Mat whole(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                        static_cast<std::size_t>(image.stride));
    cv::Mat small;
    cv::resize(whole, small, {image.width / reduction, image.height / reduction}, 0, 0, cv::INTER_AREA);
    return small;
}

Plane<const std::uint8_t> plane_of(const cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

}  // namespace

std::vector<CoarseMatch> coarse_matches(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right) {
    const int reduction = std::max(1, (left.width + reduced_width - 1) / reduced_width);
    const cv::Mat small_left = shrunk(left, reduction);
    const cv::Mat small_right = shrunk(right, reduction);
    const int reach = small_left.cols / 2;
    std::vector<CoarseMatch> matches;
    for (const calibration::CornerMatch& match : calibration::match_corners(plane_of(small_left), plane_of(small_right),
                                                                            {-reach, 2 * reach + 1}, rows_searched)) {
        matches.push_back({(match.left_x - match.right_x) * reduction, (match.left_y - match.right_y) * reduction});
    }
    return matches;
}

}  // namespace disparityd::empty_result
