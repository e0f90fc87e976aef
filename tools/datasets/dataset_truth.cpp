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

/// A value of a grey image of 8 or 16 bits.
int stored_value(const cv::Mat& image, int x, int y) {
    return image.depth() == CV_8U ? image.at<std::uint8_t>(y, x) : image.at<std::uint16_t>(y, x);
}

FloatMap read_scaled(const std::string& path, double scale) {
    const cv::Mat image = read_grey(path);
    FloatMap result{image.cols, image.rows, {}};
    result.values.reserve(image.total());
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const int stored = stored_value(image, x, y);
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

/// Marks the pixels with truth that are hidden from the right camera: `hidden` says so of the pixel of an index.
template <typename Hidden>
void mark_occluded(GroundTruth& truth, const Hidden& hidden) {
    for (std::size_t i = 0; i < truth.classes.size(); ++i) {
        if (truth.classes[i] != TruthClass::none && hidden(i)) {
            truth.classes[i] = TruthClass::occluded;
        }
    }
    truth.knows_occlusion = true;
}

/// The place of the pixel of an index.
cv::Point place_of(std::size_t index, const GroundTruth& truth) {
    return {static_cast<int>(index) % truth.width, static_cast<int>(index) / truth.width};
}

void apply_mask(GroundTruth& truth, const DatasetScene& scene) {
    cv::Mat mask = capture::read_image(scene.mask);
    if (mask.channels() == 3) {
        cv::extractChannel(mask, mask, 0);  // the official ones are grey, but some are stored as colour
    }
    check_size(scene.truth, {truth.width, truth.height}, scene.mask, {mask.cols, mask.rows});
    mark_occluded(truth, [&](std::size_t i) { return mask.at<std::uint8_t>(place_of(i, truth)) != 255; });
}

/// Reads a picture that says something of each pixel by 0 or more.
std::vector<std::uint8_t> read_flags(const std::string& path, const GroundTruth& truth, const DatasetScene& scene) {
    cv::Mat image = capture::decode_image(path);
    if (image.channels() > 1) {
        cv::extractChannel(image, image, 0);  // grey that is stored as colour
    }
    if (image.depth() != CV_8U && image.depth() != CV_16U) {
        throw std::invalid_argument(path + ": is no image of 8 or 16 bits");
    }
    check_size(scene.truth, {truth.width, truth.height}, path, {image.cols, image.rows});
    std::vector<std::uint8_t> flags;
    flags.reserve(image.total());
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            flags.push_back(stored_value(image, x, y) != 0 ? 1 : 0);
        }
    }
    return flags;
}

void apply_unseen(GroundTruth& truth, const DatasetScene& scene) {
    for (const std::string& path : scene.unseen) {
        const std::vector<std::uint8_t> unseen = read_flags(path, truth, scene);
        mark_occluded(truth, [&](std::size_t i) { return unseen[i] != 0; });
    }
}

/// Three bytes for each pixel, as Sintel packs them.
FloatMap read_sintel(const std::string& path) {
    const cv::Mat image = capture::decode_image(path);
    if (image.type() != CV_8UC3) {
        throw std::invalid_argument(path + ": is no colour image of 8 bits, as Sintel packs disparities");
    }
    FloatMap result{image.cols, image.rows, {}};
    result.values.reserve(image.total());
    for (int y = 0; y < image.rows; ++y) {
        for (int x = 0; x < image.cols; ++x) {
            const auto& bgr = image.at<cv::Vec3b>(y, x);
            result.values.push_back(static_cast<float>(bgr[2] * 4 + bgr[1] / 64.0 + bgr[0] / 16384.0));
        }
    }
    return result;
}

FloatMap read_coded(const std::string& path, TruthCoding coding, double scale) {
    if (coding == TruthCoding::sintel) {
        return read_sintel(path);
    }
    if (!base::lower_case(path).ends_with(".pfm")) {
        return read_scaled(path, scale);
    }
    FloatMap map = images::read_disparity_pfm(path);
    if (coding == TruthCoding::either_sign) {
        for (float& value : map.values) {
            value = std::abs(value);
        }
    }
    return map;
}

/// Whether the right image shows the point of a pixel, by the truth of both images.
bool sees_it_too(const FloatMap& right, cv::Point place, float disparity) {
    constexpr float nearer = 1;
    const auto at = static_cast<long>(std::lround(static_cast<double>(place.x) - static_cast<double>(disparity)));
    if (at < 0 || at >= right.width) {
        return false;
    }
    const float other = right.at(static_cast<int>(at), place.y);
    return std::isfinite(other) && other - disparity <= nearer;
}

void apply_right_truth(GroundTruth& truth, const DatasetScene& scene, double scale) {
    const FloatMap right = read_coded(scene.right_truth, scene.coding, scale);
    check_size(scene.truth, {truth.width, truth.height}, scene.right_truth, {right.width, right.height});
    mark_occluded(truth, [&](std::size_t i) { return !sees_it_too(right, place_of(i, truth), truth.disparity[i]); });
}

void apply_visible_truth(GroundTruth& truth, const DatasetScene& scene, double scale) {
    const FloatMap visible = read_scaled(scene.visible_truth, scale);
    check_size(scene.truth, {truth.width, truth.height}, scene.visible_truth, {visible.width, visible.height});
    mark_occluded(truth, [&](std::size_t i) { return !std::isfinite(visible.values[i]); });
}

}  // namespace

GroundTruth read_ground_truth(const DatasetScene& scene, double given_scale) {
    const double scale = given_scale != 0 ? given_scale : scene.scale;
    if (!std::isfinite(scale) || scale <= 0) {
        throw std::invalid_argument(scene.truth +
                                    ": what its values stand for is not known from the folder's name; "
                                    "give the scale (stored value per pixel of disparity)");
    }
    FloatMap disparity = read_coded(scene.truth, scene.coding, scale);
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
    } else if (!scene.unseen.empty()) {
        apply_unseen(truth, scene);
    } else if (!scene.right_truth.empty()) {
        apply_right_truth(truth, scene, scale);
    }
    if (!scene.objects.empty()) {
        truth.foreground = read_flags(scene.objects, truth, scene);
    }
    return truth;
}

}  // namespace disparityd::datasets
