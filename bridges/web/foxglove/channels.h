// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "bridges/ros_messages/contents.h"

namespace disparityd::foxglove {

using ros::needs_of;
using ros::Offer;
using ros::offer_of;
using ros::Wanted;

/// A channel of Foxglove's protocol; its number is the channel's id.
using Channel = ros::Content;

/// What is always the same of a channel.
struct ChannelFacts {
    Channel channel;
    std::string_view topic;
};

/// Returns all channels in the order in which they are advertised.
std::span<const ChannelFacts> all_channels();

}  // namespace disparityd::foxglove
