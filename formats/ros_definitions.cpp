// SPDX-License-Identifier: Apache-2.0
#include "formats/ros_definitions.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>

namespace disparityd::formats {
namespace {

constexpr std::string_view header = R"(==========
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
)";

constexpr std::string_view vector = R"(==========
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

constexpr std::string_view quaternion = R"(==========
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
)";

constexpr std::string_view image = R"(std_msgs/Header header
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
)";

constexpr std::string_view compressed_image = R"(std_msgs/Header header
string format
uint8[] data
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
)";

constexpr std::string_view imu = R"(std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
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
)";

struct Published {
    std::string_view type;
    std::string definition;
};

/// Each definition, with those of the types that it has behind it.
const std::array<Published, 5>& all_published() {
    const auto joined = [](std::initializer_list<std::string_view> parts) {
        std::string text;
        for (const std::string_view part : parts) {
            text += part;
        }
        return text;
    };
    static const std::array<Published, 5> all{
        {{"sensor_msgs/msg/Image", joined({image, header})},
         {"sensor_msgs/msg/CompressedImage", joined({compressed_image, header})},
         {"sensor_msgs/msg/CameraInfo", joined({camera_info, header})},
         {"sensor_msgs/msg/Imu", joined({imu, quaternion, vector, header})},
         {"tf2_msgs/msg/TFMessage", joined({transforms, vector, quaternion, header})}}};
    return all;
}

}  // namespace

std::string_view published_definition(std::string_view type) {
    const auto& all = all_published();
    const auto* const found =
        std::find_if(all.begin(), all.end(), [type](const Published& item) { return item.type == type; });
    return found == all.end() ? std::string_view() : std::string_view(found->definition);
}

}  // namespace disparityd::formats
