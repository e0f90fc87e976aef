// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/images/snapshot.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <opencv2/core.hpp>

#include "bridges/frames/planes.h"
#include "formats/pictures/png_writer.h"

namespace disparityd::web {
namespace {

using disparity::Frame;
using disparity::PlaneData;
using disparity::Product;
using frames::depth_mm;
using frames::has_metres;
using frames::metres;
using frames::value_at;

const PlaneData& plane_of(const Frame& frame, Product product) {
    const PlaneData* const plane = frame.plane(product);
    if (plane == nullptr) {
        throw std::runtime_error("the frame does not carry this image");
    }
    return *plane;
}

/// 16-bit values of the disparities.
template <typename Convert>
cv::Mat converted(const PlaneData& plane, const Convert& convert) {
    cv::Mat picture(static_cast<int>(plane.height), static_cast<int>(plane.width), CV_16UC1);
    for (std::uint32_t y = 0; y < plane.height; ++y) {
        auto* const row = picture.ptr<std::uint16_t>(static_cast<int>(y));
        for (std::uint32_t x = 0; x < plane.width; ++x) {
            row[x] = convert(value_at<std::int16_t>(plane, x, y));
        }
    }
    return picture;
}

cv::Mat disparity_picture(const Frame& frame) {
    if (frame.d_min < 0 || frame.d_min + static_cast<std::int64_t>(frame.disparities) > 256) {
        throw std::runtime_error("a 16-bit PNG holds disparities from 0 to 255.99 px, the daemon searches others");
    }
    return converted(plane_of(frame, Product::disparity), [&](std::int16_t d16) {
        return static_cast<std::uint16_t>(d16 == frame.invalid ? 0 : std::clamp(16 * int{d16}, 1, 65535));
    });
}

/// Returns the values as they are, without a copy.
cv::Mat plane_picture(const Frame& frame, Image image) {
    const PlaneData* const plane = shown_plane(frame, image);
    if (plane == nullptr) {
        throw std::runtime_error("the frame does not carry this image");
    }
    const int type = plane->bytes_per_pixel == 3 ? CV_8UC3 : plane->bytes_per_pixel == 2 ? CV_16UC1 : CV_8UC1;
    return {static_cast<int>(plane->height), static_cast<int>(plane->width), type,
            const_cast<std::uint8_t*>(plane->bytes.data())};
}

cv::Mat picture_of(const Frame& frame, Image image) {
    if (image == Image::disparity) {
        return disparity_picture(frame);
    }
    if (image == Image::depth) {
        return converted(plane_of(frame, Product::disparity), [&](std::int16_t d16) { return depth_mm(frame, d16); });
    }
    return plane_picture(frame, image);
}

template <typename T>
void append(std::string& bytes, T value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
}

/// Appends the points of a row, and returns how many.
std::size_t append_row(std::string& bytes, const Frame& frame, const cv::Mat& left, std::uint32_t y) {
    const PlaneData& plane = plane_of(frame, Product::disparity);
    std::size_t points = 0;
    for (std::uint32_t x = 0; x < plane.width; ++x) {
        const auto d16 = value_at<std::int16_t>(plane, x, y);
        const auto z = d16 == frame.invalid ? std::nullopt : metres(frame, d16 / 16.0);
        if (!z) {
            continue;
        }
        append(bytes, static_cast<float>((x - frame.cx) * *z / frame.f));
        append(bytes, static_cast<float>((y - frame.cy) * *z / frame.f));
        append(bytes, static_cast<float>(*z));
        const std::uint8_t* const pixel = left.ptr(static_cast<int>(y), static_cast<int>(x));
        const bool grey = left.channels() == 1;
        bytes += {static_cast<char>(pixel[grey ? 0 : 2]), static_cast<char>(pixel[grey ? 0 : 1]),
                  static_cast<char>(pixel[0])};
        ++points;
    }
    return points;
}

}  // namespace

std::string png_of(const LiveFrame& live, Image image) {
    const cv::Mat picture = picture_of(live.frame, image);
    return formats::png_of({picture.data, picture.cols, picture.rows, picture.step, picture.channels(),
                            static_cast<int>(8 * picture.elemSize1())},
                           formats::PngContent::picture);
}

std::string ply_of(const LiveFrame& live) {
    const Frame& frame = live.frame;
    if (!has_metres(frame)) {
        throw std::runtime_error("the frame has no calibration: points have no place; see docs/calibration.md");
    }
    const cv::Mat left = plane_picture(frame, Image::left);
    const PlaneData& plane = plane_of(frame, Product::disparity);
    if (left.cols != static_cast<int>(plane.width) || left.rows != static_cast<int>(plane.height)) {
        throw std::runtime_error("the left image and the disparity have different sizes");
    }
    std::string points;
    std::size_t count = 0;
    for (std::uint32_t y = 0; y < plane.height; ++y) {
        count += append_row(points, frame, left, y);
    }
    return "ply\nformat binary_little_endian 1.0\ncomment disparityd frame " + std::to_string(frame.sequence) +
           "\nelement vertex " + std::to_string(count) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty "
           "uchar blue\nend_header\n" +
           points;
}

}  // namespace disparityd::web
