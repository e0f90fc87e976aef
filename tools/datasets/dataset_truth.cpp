// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "base/number_text.h"
#include "base/words.h"
#include "capture/images/image_files.h"
#include "tools/datasets/dataset.h"

namespace disparityd::datasets {

namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();
constexpr int largest_side = 8192;

struct FloatImage {
    int width = 0;
    int height = 0;
    std::vector<float> values;
};

/// Whether the pixels that a header announces are there, before memory is taken for them.
void check_length(std::ifstream& file, const std::string& path, double announced) {
    const auto pixels_at = file.tellg();
    file.seekg(0, std::ios::end);
    const auto there = static_cast<double>(file.tellg() - pixels_at);
    file.seekg(pixels_at);
    if (there < announced) {
        throw std::invalid_argument(path + ": is shorter than its size says: found " + base::number_text(there) +
                                    " bytes of pixels, expected " + base::number_text(announced));
    }
}

/// Portable float map with one channel: rows from the bottom up, a negative scale means little endian.
FloatImage read_pfm(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string magic, width, height, scale;
    file >> magic >> width >> height >> scale;
    file.get();
    const auto w = base::parse_number(width);
    const auto h = base::parse_number(height);
    const auto s = base::parse_number(scale);
    const auto whole = [](std::optional<double> side) {
        return side && *side >= 1 && *side <= largest_side && *side == std::floor(*side);
    };
    if (!file || magic != "Pf" || !whole(w) || !whole(h) || !s || *s == 0) {
        throw std::invalid_argument(path + ": is no PFM file with one channel and sides of 1 to 8192 pixels");
    }
    check_length(file, path, 4 * *w * *h);
    FloatImage image{static_cast<int>(*w), static_cast<int>(*h), {}};
    const auto row = static_cast<std::size_t>(image.width);
    image.values.resize(row * static_cast<std::size_t>(image.height));
    const bool swap = (*s < 0) != (std::endian::native == std::endian::little);
    std::vector<std::uint32_t> bits(row);
    for (int y = image.height - 1; y >= 0; --y) {
        file.read(reinterpret_cast<char*>(bits.data()), static_cast<std::streamsize>(4 * row));
        if (!file) {
            throw std::invalid_argument(path + ": is shorter than its size of " + width + "x" + height + " says");
        }
        for (std::size_t x = 0; x < row; ++x) {
            const float value = std::bit_cast<float>(swap ? __builtin_bswap32(bits[x]) : bits[x]);
            image.values[static_cast<std::size_t>(y) * row + x] = std::isfinite(value) ? value : unknown;
        }
    }
    return image;
}

cv::Mat read_grey(const std::string& path) {
    cv::Mat image = capture::decode_image(path);
    if (image.channels() != 1 || (image.depth() != CV_8U && image.depth() != CV_16U)) {
        throw std::invalid_argument(path + ": is no grey image of 8 or 16 bits");
    }
    return image;
}

FloatImage read_scaled(const std::string& path, double scale) {
    const cv::Mat image = read_grey(path);
    FloatImage result{image.cols, image.rows, {}};
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
    const FloatImage visible = read_scaled(scene.visible_truth, scale);
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
    FloatImage disparity = pfm ? read_pfm(scene.truth) : read_scaled(scene.truth, scale);
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
