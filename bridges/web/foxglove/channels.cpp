// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/channels.h"

#include <array>

namespace disparityd::foxglove {
namespace {

constexpr std::array channels{
    ChannelFacts{Channel::left_image, "/left/image_rect", "sensor_msgs/Image"},
    ChannelFacts{Channel::left_jpeg, "/left/image_rect/compressed", "sensor_msgs/CompressedImage"},
    ChannelFacts{Channel::left_info, "/left/camera_info", "sensor_msgs/CameraInfo"},
    ChannelFacts{Channel::right_info, "/right/camera_info", "sensor_msgs/CameraInfo"},
    ChannelFacts{Channel::disparity, "/disparity", "stereo_msgs/DisparityImage"},
    ChannelFacts{Channel::depth, "/depth/image_rect_raw", "sensor_msgs/Image"},
    ChannelFacts{Channel::depth_mm, "/depth/image_rect", "sensor_msgs/Image"},
    ChannelFacts{Channel::depth_error, "/depth/error", "sensor_msgs/Image"},
    ChannelFacts{Channel::confidence, "/confidence", "sensor_msgs/Image"},
    ChannelFacts{Channel::points, "/points", "sensor_msgs/PointCloud2"},
    ChannelFacts{Channel::scan, "/scan", "sensor_msgs/LaserScan"},
    ChannelFacts{Channel::transforms, "/tf", "tf2_msgs/TFMessage"},
    ChannelFacts{Channel::imu, "/imu", "sensor_msgs/Imu"},
    ChannelFacts{Channel::magnetic_field, "/magnetic_field", "sensor_msgs/MagneticField"},
    ChannelFacts{Channel::imu_temperature, "/temperature/imu", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::camera_temperature, "/temperature/camera", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::left_temperature, "/temperature/left", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::right_temperature, "/temperature/right", "sensor_msgs/Temperature"},
    ChannelFacts{Channel::pressure, "/pressure", "sensor_msgs/FluidPressure"},
    ChannelFacts{Channel::humidity, "/humidity", "sensor_msgs/RelativeHumidity"},
    ChannelFacts{Channel::status, "/status", ""},
};

}  // namespace

std::span<const ChannelFacts> all_channels() {
    return channels;
}

}  // namespace disparityd::foxglove
