// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/encoded_frame.h"

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>

#include "bridges/web/foxglove/camera_info_message.h"
#include "bridges/web/foxglove/image_messages.h"
#include "bridges/web/foxglove/laser_scan_message.h"
#include "bridges/web/foxglove/message_header.h"
#include "bridges/web/foxglove/point_cloud_message.h"
#include "formats/cdr_writer.h"

namespace disparityd::foxglove {
namespace {

/// Returns a tf2_msgs/msg/TFMessage that turns camera_frame (z up) into left_frame (z ahead), so that a viewer shows
/// points upright.
std::string optical_transform(std::int64_t realtime_ns) {
    CdrWriter cdr(192);
    cdr.length(1);
    write_header(cdr, realtime_ns, camera_frame);
    cdr.text(left_frame);
    cdr.f64_array(std::array{0.0, 0.0, 0.0});         // both are in the same place
    cdr.f64_array(std::array{-0.5, 0.5, -0.5, 0.5});  // x, y, z, w: a third of a turn about (-1, 1, -1)
    return cdr.take();
}

using disparity::Frame;

std::optional<std::string> scan_message(const Frame& frame) {
    try {
        const std::optional<disparity::Scan> scan = frame.scan();
        return scan ? laser_scan(*scan, frame.realtime_ns) : std::nullopt;
    } catch (const std::runtime_error&) {  // a scan of another version, from a newer daemon
        return std::nullopt;
    }
}

std::optional<std::string> encode(Channel channel, const Frame& frame, const Encoding& encoding) {
    switch (channel) {
        case Channel::left_image: return left_image(frame);
        case Channel::left_jpeg: return left_jpeg(frame, encoding.jpeg_quality);
        case Channel::left_info: return camera_info(frame, Camera::left);
        case Channel::right_info: return camera_info(frame, Camera::right);
        case Channel::disparity: return disparity_image(frame);
        case Channel::depth: return depth_image(frame);
        case Channel::depth_mm: return depth_mm_image(frame);
        case Channel::depth_error: return depth_error_image(frame);
        case Channel::confidence: return confidence_image(frame);
        case Channel::points: return point_cloud(frame, encoding.most_points);
        case Channel::scan: return scan_message(frame);
        case Channel::transforms: return optical_transform(frame.realtime_ns);
        default: return std::nullopt;
    }
}

}  // namespace

EncodedFrame::EncodedFrame(const Frame& frame, const Encoding& encoding) : frame_(frame), encoding_(encoding) {}

Payload EncodedFrame::payload(Channel channel) {
    const auto [place, is_new] = payloads_.try_emplace(channel);
    if (is_new) {
        if (std::optional<std::string> bytes = encode(channel, frame_, encoding_)) {
            place->second = std::make_shared<const std::string>(std::move(*bytes));
        }
    }
    return place->second;
}

Payloads EncodedFrame::payloads(std::span<const Channel> channels) {
    Payloads list;
    for (const Channel channel : channels) {
        if (Payload message = payload(channel)) {
            list.emplace(channel, std::move(message));
        }
    }
    return list;
}

}  // namespace disparityd::foxglove
