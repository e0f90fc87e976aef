// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include <opencv2/core/mat.hpp>

#include "formats/ros_message.h"

namespace disparityd::capture {

/// An image of a bag: grey (CV_8UC1), YUYV (CV_8UC2), or blue, green, red (CV_8UC3). It owns its pixels.
struct BagImage {
    std::int64_t stamp_ns = 0;
    cv::Mat pixels;

    std::size_t bytes() const { return pixels.total() * pixels.elemSize(); }
};

/// Returns the stamp of a message's header, ns since 1970; `log_ns` where it has none. Throws std::runtime_error for
/// one before 1970.
std::int64_t stamp_of(const formats::RosMessage& message, std::int64_t log_ns);

/// Reads a sensor_msgs/msg/Image or CompressedImage. `bits` are those of values in images of 16 bits, 9 to 16; 0: 16.
/// Throws std::runtime_error with one line, which does not say which message it is: for an encoding that is not taken,
/// for data that are too short, for more than 8192 pixels on a side.
cv::Mat pixels_of(const formats::RosMessage& message, int bits);

}  // namespace disparityd::capture
