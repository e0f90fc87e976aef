// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_definitions.h"

#include <algorithm>
#include <array>
#include <utility>

namespace disparityd::formats {
namespace {

constexpr std::string_view image = R"(std_msgs/Header header
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
==========
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";

constexpr std::string_view compressed_image = R"(std_msgs/Header header
string format
uint8[] data
==========
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";

constexpr std::string_view camera_info = R"(std_msgs/Header header
uint32 height
uint32 width
string distortion_model
float64[] d
float64[9] k
float64[9] r
float64[12] p
uint32 binning_x
uint32 binning_y
RegionOfInterest roi
==========
MSG: sensor_msgs/RegionOfInterest
uint32 x_offset
uint32 y_offset
uint32 height
uint32 width
bool do_rectify
==========
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";

constexpr std::string_view imu = R"(std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
==========
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
==========
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
==========
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";

constexpr std::string_view transforms = R"(geometry_msgs/TransformStamped[] transforms
==========
MSG: geometry_msgs/TransformStamped
std_msgs/Header header
string child_frame_id
Transform transform
==========
MSG: geometry_msgs/Transform
Vector3 translation
Quaternion rotation
==========
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
==========
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
==========
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";

constexpr std::array<std::pair<std::string_view, std::string_view>, 5> published{
    {{"sensor_msgs/msg/Image", image},
     {"sensor_msgs/msg/CompressedImage", compressed_image},
     {"sensor_msgs/msg/CameraInfo", camera_info},
     {"sensor_msgs/msg/Imu", imu},
     {"tf2_msgs/msg/TFMessage", transforms}}};

}  // namespace

std::string_view published_definition(std::string_view type) {
    const auto* const found =
        std::find_if(published.begin(), published.end(), [type](const auto& item) { return item.first == type; });
    return found == published.end() ? std::string_view() : found->second;
}

}  // namespace disparityd::formats
