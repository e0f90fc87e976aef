// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/encoded_frame.h"

#include <optional>
#include <utility>

namespace disparityd::foxglove {

EncodedFrame::EncodedFrame(const disparity::Frame& frame, const ros::Encoding& encoding)
    : frame_(frame), encoding_(encoding) {}

Payload EncodedFrame::payload(Channel channel) {
    const auto [place, is_new] = payloads_.try_emplace(channel);
    if (is_new) {
        if (std::optional<std::string> bytes = ros::encode(channel, frame_, encoding_)) {
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
