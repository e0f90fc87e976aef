// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/empty_scene.h"

#include <opencv2/imgproc.hpp>

#include "calibration/empty_result/empty_result.h"

namespace disparityd::eval {
namespace {

cv::Mat luma_of(const cv::Mat& image) {
    cv::Mat converted = image;
    if (image.channels() == 3) {
        cv::cvtColor(image, converted, cv::COLOR_BGR2GRAY);
    }
    return converted;
}

Plane<const std::uint8_t> view_of(const cv::Mat& image) {
    return {image.data, image.cols, image.rows, static_cast<std::ptrdiff_t>(image.step)};
}

}  // namespace

std::string empty_scene_note(const Scene& scene, const MatcherResult& result) {
    if (result.confidence.empty()) {
        return {};
    }
    const cv::Mat left = luma_of(scene.left), right = luma_of(scene.right);
    empty_result::EmptyResult counted(result.range);
    counted.add(view_of(left), view_of(right), {result.confidence.data(), result.width, result.height, result.width});
    const std::string note = counted.note(std::nullopt);
    return note.empty() ? note : scene.name + ": " + note;
}

}  // namespace disparityd::eval
