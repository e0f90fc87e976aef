// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include <webp/decode.h>

#include "capture/images/image_decoders.h"

namespace disparityd::capture {

cv::Mat decode_webp(std::span<const std::uint8_t> file, const std::string& path) {
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(file.data(), file.size(), &features) != VP8_STATUS_OK) {
        throw std::invalid_argument(path + ": is damaged: libwebp cannot read the header");
    }
    if (features.has_animation != 0) {
        throw std::invalid_argument(
            path + ": found a WebP that moves, allowed is a still picture: store its frames one by one");
    }
    const bool alpha = features.has_alpha != 0;
    cv::Mat image(features.height, features.width, alpha ? CV_8UC4 : CV_8UC3);
    const std::size_t size = image.total() * image.elemSize();
    const auto decode = alpha ? WebPDecodeBGRAInto : WebPDecodeBGRInto;
    if (decode(file.data(), file.size(), image.data, size, static_cast<int>(image.step)) == nullptr) {
        throw std::invalid_argument(path + ": is damaged: libwebp cannot decode it");
    }
    return image;
}

}  // namespace disparityd::capture
