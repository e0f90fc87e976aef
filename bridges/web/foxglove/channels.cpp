// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/channels.h"

#include <array>

namespace disparityd::foxglove {
namespace {

constexpr std::array channels{
    ChannelFacts{Channel::left_image, "/left/image_rect"},
    ChannelFacts{Channel::left_jpeg, "/left/image_rect/compressed"},
    ChannelFacts{Channel::left_info, "/left/camera_info"},
    ChannelFacts{Channel::right_info, "/right/camera_info"},
    ChannelFacts{Channel::disparity, "/disparity"},
    ChannelFacts{Channel::depth, "/depth/image_rect_raw"},
    ChannelFacts{Channel::depth_mm, "/depth/image_rect"},
    ChannelFacts{Channel::depth_error, "/depth/error"},
    ChannelFacts{Channel::confidence, "/confidence"},
    ChannelFacts{Channel::points, "/points"},
    ChannelFacts{Channel::scan, "/scan"},
    ChannelFacts{Channel::transforms, "/tf"},
    ChannelFacts{Channel::imu, "/imu"},
    ChannelFacts{Channel::magnetic_field, "/magnetic_field"},
    ChannelFacts{Channel::imu_temperature, "/temperature/imu"},
    ChannelFacts{Channel::camera_temperature, "/temperature/camera"},
    ChannelFacts{Channel::left_temperature, "/temperature/left"},
    ChannelFacts{Channel::right_temperature, "/temperature/right"},
    ChannelFacts{Channel::pressure, "/pressure"},
    ChannelFacts{Channel::humidity, "/humidity"},
    ChannelFacts{Channel::status, "/status"},
};

}  // namespace

std::span<const ChannelFacts> all_channels() {
    return channels;
}

}  // namespace disparityd::foxglove
