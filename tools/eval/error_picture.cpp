// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/error_picture.h"

#include <cmath>
#include <vector>

#include "tools/images/picture.h"

namespace disparityd::eval {
namespace {

const cv::Vec3b wrong(40, 40, 230);
const cv::Vec3b wrong_and_occluded(30, 150, 240);
const cv::Vec3b rejected(200, 110, 30);
const cv::Vec3b unknown(24, 40, 16);

cv::Vec3b judge(float disparity, float truth, bool occluded) {
    if (!std::isfinite(truth)) {
        return unknown;
    }
    if (!std::isfinite(disparity)) {
        return rejected;
    }
    const float error = std::abs(disparity - truth);
    if (error > 1.0F) {
        return occluded ? wrong_and_occluded : wrong;
    }
    const auto level = static_cast<std::uint8_t>(std::lround(error * 160));
    return {level, level, level};
}

}  // namespace

cv::Mat error_picture(const Scene& scene, const MatcherResult& result) {
    const images::FloatMap disparity = images::to_float(result.map());
    cv::Mat errors(result.height, result.width, CV_8UC3);
    for (int y = 0; y < result.height; ++y) {
        for (int x = 0; x < result.width; ++x) {
            const auto i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(result.width) + static_cast<std::size_t>(x);
            const bool occluded = !scene.non_occluded.empty() && scene.non_occluded[i] == 0;
            errors.at<cv::Vec3b>(y, x) = judge(disparity.at(x, y), scene.truth.at(x, y), occluded);
        }
    }
    const images::ColourScale scale = images::fitted(result.map());
    cv::Mat left_and_disparity = images::picture(scene.left, result.map(), scale, {});
    const int images_width = 2 * result.width;
    std::vector<cv::Mat> parts{left_and_disparity.colRange(0, images_width), errors,
                               left_and_disparity.colRange(images_width, left_and_disparity.cols)};
    cv::Mat all;
    cv::hconcat(parts, all);
    return all;
}

}  // namespace disparityd::eval
