// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>

#include <opencv2/imgproc.hpp>

#include "base/message_text.h"
#include "capture/bayer.h"
#include "capture/images/image_files.h"

namespace disparityd::capture {
namespace {

constexpr int no_conversion = -1;

/// How the pixels of an encoding lie in memory, and what makes grey, YUYV or blue, green, red of them.
struct Encoding {
    std::string_view name;
    int type;
    int conversion;
};

// ROS names Bayer patterns by the four pixels of the first two rows.
constexpr std::array<Encoding, 15> encodings{{{"mono8", CV_8UC1, no_conversion},
                                              {"8UC1", CV_8UC1, no_conversion},
                                              {"mono16", CV_16UC1, no_conversion},
                                              {"bgr8", CV_8UC3, no_conversion},
                                              {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
                                              {"bgra8", CV_8UC4, cv::COLOR_BGRA2BGR},
                                              {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGR},
                                              {"yuv422_yuy2", CV_8UC2, no_conversion},
                                              {"yuyv", CV_8UC2, no_conversion},
                                              {"yuv422", CV_8UC2, no_conversion},
                                              {"uyvy", CV_8UC2, no_conversion},
                                              {"bayer_rggb8", CV_8UC1, demosaicing(1, 1)},
                                              {"bayer_bggr8", CV_8UC1, demosaicing(0, 0)},
                                              {"bayer_gbrg8", CV_8UC1, demosaicing(0, 1)},
                                              {"bayer_grbg8", CV_8UC1, demosaicing(1, 0)}}};

const Encoding& encoding_of(std::string_view name) {
    const auto found =
        std::find_if(encodings.begin(), encodings.end(), [name](const Encoding& known) { return known.name == name; });
    if (found == encodings.end()) {
        throw std::runtime_error("found images of the encoding '" + base::printable(name) +
                                 "', allowed are mono8, mono16, rgb8, bgr8, rgba8, bgra8, yuv422, yuv422_yuy2 and "
                                 "bayer_rggb8, bggr8, gbrg8, grbg8");
    }
    return *found;
}

int side(const formats::RosMessage& message, std::string_view field) {
    constexpr int most = 8192;
    const std::int64_t value = message.integer(field);
    if (value < 1 || value > most) {
        throw std::runtime_error("found an image whose " + std::string(field) + " is " + std::to_string(value) +
                                 ", allowed is 1 to " + std::to_string(most));
    }
    return static_cast<int>(value);
}

/// Exchanges the two bytes of each pixel.
void swap_pairs(cv::Mat& image) {
    for (int y = 0; y < image.rows; ++y) {
        auto* row = image.ptr<std::uint8_t>(y);
        for (int x = 0; x < image.cols; ++x) {
            std::swap(row[2 * x], row[2 * x + 1]);
        }
    }
}

/// Returns the pixels as they lie in the message, rows without gaps.
cv::Mat raw_pixels(const formats::RosMessage& message, const Encoding& encoding) {
    cv::Mat image(side(message, "height"), side(message, "width"), encoding.type);
    const std::span<const std::uint8_t> data = message.bytes("data");
    const std::size_t row = static_cast<std::size_t>(image.cols) * image.elemSize();
    const auto step = static_cast<std::size_t>(std::max<std::int64_t>(message.integer("step"), 0));
    const auto rows = static_cast<std::size_t>(image.rows);
    if (step < row || data.size() < (rows - 1) * step + row) {
        throw std::runtime_error("found an image of " + base::size_text(image.cols, image.rows) + " " +
                                 std::string(encoding.name) + " with " + std::to_string(data.size()) +
                                 " bytes and rows of " + std::to_string(step) + ", expected " +
                                 std::to_string(rows * row) + " and " + std::to_string(row));
    }
    for (std::size_t y = 0; y < rows; ++y) {
        std::memcpy(image.ptr(static_cast<int>(y)), data.data() + y * step, row);
    }
    return image;
}

cv::Mat pixels_of_image(const formats::RosMessage& message, int bits) {
    const Encoding& encoding = encoding_of(message.text("encoding"));
    cv::Mat image = raw_pixels(message, encoding);
    if (encoding.type == CV_16UC1) {
        const bool big = message.number("is_bigendian") != 0;
        if (big != (std::endian::native == std::endian::big)) {
            swap_pairs(image);
        }
        return as_8_bits(image, "image", {bits == 0 ? 16 : bits});
    }
    if (encoding.name == "yuv422" || encoding.name == "uyvy") {
        swap_pairs(image);
    }
    if (encoding.type == CV_8UC2 && image.cols % 2 != 0) {
        throw std::runtime_error("found an image of " + std::string(encoding.name) + " that is " +
                                 std::to_string(image.cols) + " pixels wide, expected an even width");
    }
    if (encoding.conversion != no_conversion) {
        cv::Mat converted;
        cv::cvtColor(image, converted, encoding.conversion);
        return converted;
    }
    return image;
}

cv::Mat pixels_of_compressed(const formats::RosMessage& message, int bits) {
    const std::span<const std::uint8_t> data = message.bytes("data");
    const auto begins = [data](std::string_view text) {
        return data.size() >= text.size() && std::memcmp(data.data(), text.data(), text.size()) == 0;
    };
    if (!begins("\xff\xd8") && !begins("\x89PNG")) {
        throw std::runtime_error("found data of the format '" + base::printable(message.text("format")) +
                                 "' that are neither JPEG nor PNG");
    }
    return as_8_bits(decode_image(data, "image"), "image", {bits == 0 ? 16 : bits});
}

}  // namespace

std::int64_t stamp_of(const formats::RosMessage& message, std::int64_t log_ns) {
    constexpr std::int64_t second_ns = 1'000'000'000;
    const std::int64_t seconds = message.integer("header.stamp.sec");
    const std::int64_t nanoseconds = message.integer("header.stamp.nanosec");
    if (seconds < 0 || nanoseconds < 0) {
        throw std::runtime_error("found a stamp of " + std::to_string(seconds) + " s and " +
                                 std::to_string(nanoseconds) + " ns, allowed are times from 1970 on");
    }
    const std::int64_t stamp = seconds * second_ns + nanoseconds;
    return stamp != 0 ? stamp : log_ns;
}

cv::Mat pixels_of(const formats::RosMessage& message, int bits) {
    try {
        return message.has("encoding") ? pixels_of_image(message, bits) : pixels_of_compressed(message, bits);
    } catch (const std::invalid_argument& error) {  // of the decoders of images
        throw std::runtime_error(error.what());
    }
}

}  // namespace disparityd::capture
