// SPDX-License-Identifier: Apache-2.0
#include "capture/images/mask_image.h"

#include <stdexcept>

#include "capture/images/image_files.h"

namespace disparityd::capture {

namespace {

cv::Mat decoded(const std::string& path) {
    try {
        return decode_image(path);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument("mask: " + std::string(error.what()));
    }
}

}  // namespace

MaskImage read_mask_image(const std::string& path) {
    const cv::Mat image = decoded(path);
    if (image.type() != CV_8UC1) {
        throw std::invalid_argument("mask: " + path + ": found " + std::to_string(image.channels()) + " channels of " +
                                    std::to_string(8 * image.elemSize1()) +
                                    " bits, allowed: one of 8 bits (grey PNG or PGM)");
    }
    MaskImage mask{image.cols, image.rows, {}};
    for (int y = 0; y < image.rows; ++y) {
        mask.grey.insert(mask.grey.end(), image.ptr(y), image.ptr(y) + image.cols);
    }
    return mask;
}

}  // namespace disparityd::capture
