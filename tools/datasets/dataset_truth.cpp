// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "base/number_text.h"
#include "base/words.h"
#include "capture/images/image_files.h"
#include "tools/datasets/dataset.h"
#include "tools/images/disparity_file.h"

namespace disparityd::datasets {

namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();

using images::FloatMap;

cv::Mat read_grey(const std::string& path) {
    cv::Mat image = capture::decode_image(path);
    if (image.channels() != 1 || (image.depth() != CV_8U && image.depth() != CV_16U)) {
        throw std::invalid_argument(path + ": is no grey image of 8 or 16 bits");
    }
    return image;
}

FloatMap read_scaled(const std::string& path, double scale) {
    const cv::Mat image = read_grey(path);
    FloatMap result{image.cols, image.rows, {}};
    result.values.reserve(image.total());
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const int stored = image.depth() == CV_8U ? image.at<std::uint8_t>(y, x) : image.at<std::uint16_t>(y, x);
            result.values.push_back(stored == 0 ? unknown : static_cast<float>(stored / scale));
        }
    }
    return result;
}

void check_size(const std::string& first, capture::ImageSize first_size, const std::string& second,
                capture::ImageSize second_size) {
    if (first_size != second_size) {
        throw std::invalid_argument(capture::unequal_sizes(first, first_size, second, second_size));
    }
}

void apply_mask(GroundTruth& truth, const DatasetScene& scene) {
    cv::Mat mask = capture::read_image(scene.mask);
    if (mask.channels() == 3) {
        cv::extractChannel(mask, mask, 0);  // the official ones are grey, but some are stored as colour
    }
    check_size(scene.truth, {truth.width, truth.height}, scene.mask, {mask.cols, mask.rows});
    for (std::size_t i = 0; i < truth.classes.size(); ++i) {
        const int x = static_cast<int>(i) % truth.width;
        const int y = static_cast<int>(i) / truth.width;
        if (truth.classes[i] != TruthClass::none && mask.at<std::uint8_t>(y, x) != 255) {
            truth.classes[i] = TruthClass::occluded;
        }
    }
    truth.knows_occlusion = true;
}

void apply_visible_truth(GroundTruth& truth, const DatasetScene& scene, double scale) {
    const FloatMap visible = read_scaled(scene.visible_truth, scale);
    check_size(scene.truth, {truth.width, truth.height}, scene.visible_truth, {visible.width, visible.height});
    for (std::size_t i = 0; i < truth.classes.size(); ++i) {
        if (truth.classes[i] != TruthClass::none && !std::isfinite(visible.values[i])) {
            truth.classes[i] = TruthClass::occluded;
        }
    }
    truth.knows_occlusion = true;
}

}  // namespace

GroundTruth read_ground_truth(const DatasetScene& scene, double given_scale) {
    const double scale = given_scale != 0 ? given_scale : scene.scale;
    if (!std::isfinite(scale) || scale <= 0) {
        throw std::invalid_argument(scene.truth +
                                    ": what its values stand for is not known from the folder's name; "
                                    "give the scale (stored value per pixel of disparity)");
    }
    const bool pfm = base::lower_case(scene.truth).ends_with(".pfm");
    FloatMap disparity = pfm ? images::read_disparity_pfm(scene.truth) : read_scaled(scene.truth, scale);
    if (const auto size = capture::peek_image_size(scene.left)) {
        check_size(scene.left, *size, scene.truth, {disparity.width, disparity.height});
    }
    GroundTruth truth;
    truth.width = disparity.width;
    truth.height = disparity.height;
    truth.disparity = std::move(disparity.values);
    truth.classes.reserve(truth.disparity.size());
    for (const float value : truth.disparity) {
        truth.classes.push_back(std::isfinite(value) ? TruthClass::visible : TruthClass::none);
    }
    if (!scene.mask.empty()) {
        apply_mask(truth, scene);
    } else if (!scene.visible_truth.empty()) {
        apply_visible_truth(truth, scene, scale);
    }
    return truth;
}

}  // namespace disparityd::datasets
