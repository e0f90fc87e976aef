// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/pictures/error_picture.h"

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tools/images/picture.h"

namespace disparityd::eval {
namespace {

const cv::Vec3b wrong(40, 40, 230);
const cv::Vec3b wrong_and_occluded(30, 150, 240);
const cv::Vec3b rejected(200, 110, 30);
const cv::Vec3b no_truth(24, 70, 16);
constexpr double level_of_one_px = 160;

cv::Vec3b grey_of(double error) {
    return cv::Vec3b::all(static_cast<std::uint8_t>(std::lround(error * level_of_one_px)));
}

cv::Vec3b judge(float disparity, float truth, bool occluded) {
    if (!std::isfinite(truth)) {
        return no_truth;
    }
    if (!std::isfinite(disparity)) {
        return rejected;
    }
    const float error = std::abs(disparity - truth);
    if (error > 1.0F) {
        return occluded ? wrong_and_occluded : wrong;
    }
    return grey_of(error);
}

}  // namespace

const std::vector<images::LegendRow>& error_colours() {
    static const std::vector<images::LegendRow> colours{{grey_of(0), "0 px"},
                                                        {grey_of(0.5), "0.5 px"},
                                                        {grey_of(1), "1 px"},
                                                        {wrong, "over 1 px"},
                                                        {wrong_and_occluded, "over 1 px, occluded"},
                                                        {rejected, "rejected"},
                                                        {no_truth, "no ground truth"}};
    return colours;
}

cv::Mat error_image(const Scene& scene, const images::FloatMap& disparity) {
    cv::Mat errors(disparity.height, disparity.width, CV_8UC3);
    for (int y = 0; y < disparity.height; ++y) {
        for (int x = 0; x < disparity.width; ++x) {
            const auto i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(disparity.width) + static_cast<std::size_t>(x);
            const bool occluded = !scene.non_occluded.empty() && scene.non_occluded[i] == 0;
            errors.at<cv::Vec3b>(y, x) = judge(disparity.at(x, y), scene.truth.at(x, y), occluded);
        }
    }
    return errors;
}

cv::Mat error_picture(const Scene& scene, const MatcherResult& result) {
    const cv::Mat errors = error_image(scene, images::to_float(result.map()));
    // The range that covers the truth: the same colours for every method, so that their pictures can be compared.
    const images::ColourScale scale = images::whole_range(result.range);
    const cv::Mat bar = images::scale_bar(result.height, scale, {});
    const cv::Mat all = images::picture(scene.left, result.map(), scale, {});
    const cv::Mat left_and_disparity = all(cv::Rect(0, 0, 2 * result.width, result.height));
    return images::side_by_side(
        {left_and_disparity, errors, bar, images::colour_legend(result.height, "error", error_colours())});
}

}  // namespace disparityd::eval
