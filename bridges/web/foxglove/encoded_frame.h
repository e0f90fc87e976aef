// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "bridges/ros_messages/encode.h"
#include "bridges/web/foxglove/channels.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::foxglove {

/// The bytes of a message; shared, as several sessions may send the same ones. nullptr: there is no message.
using Payload = std::shared_ptr<const std::string>;

/// Messages of several channels.
using Payloads = std::map<Channel, Payload>;

/// The messages of one frame. Each is encoded when the first session asks for it, and once for all sessions. One thread
/// uses it.
class EncodedFrame {
public:
    /// The frame outlives the object.
    explicit EncodedFrame(const disparity::Frame& frame, const ros::Encoding& encoding = {});

    /// Returns the message of a channel; nullptr when the frame does not carry what it needs, and for channels that do
    /// not come with frames.
    Payload payload(Channel channel);

    /// Returns the messages of those of the channels that have one.
    Payloads payloads(std::span<const Channel> channels);

private:
    const disparity::Frame& frame_;
    ros::Encoding encoding_;
    Payloads payloads_;  ///< nullptr: it was found that there is none
};

}  // namespace disparityd::foxglove
