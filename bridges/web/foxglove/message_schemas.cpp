// SPDX-License-Identifier: Apache-2.0
#include "bridges/web/foxglove/message_schemas.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "base/words.h"
#include "clients/json/message_json.h"
#include "proto/disparity.pb.h"

namespace disparityd::foxglove {
namespace {

struct Definition {
    std::string_view name;
    std::string_view fields;
};

constexpr std::array definitions{
    Definition{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Definition{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Definition{"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    Definition{"geometry_msgs/TransformStamped",
               "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    Definition{"sensor_msgs/RegionOfInterest",
               "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    Definition{"sensor_msgs/Image",
               "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
               "uint8[] data\n"},
    Definition{"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    Definition{"sensor_msgs/CameraInfo",
               "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
               "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
               "sensor_msgs/RegionOfInterest roi\n"},
    Definition{"sensor_msgs/PointField",
               "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
               "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    Definition{"sensor_msgs/PointCloud2",
               "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
               "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    Definition{"sensor_msgs/LaserScan",
               "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
               "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
               "float32[] intensities\n"},
    Definition{"sensor_msgs/Imu",
               "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
               "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
               "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n"},
    Definition{"sensor_msgs/MagneticField",
               "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance\n"},
    Definition{"sensor_msgs/Temperature", "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n"},
    Definition{"sensor_msgs/FluidPressure", "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n"},
    Definition{"sensor_msgs/RelativeHumidity", "std_msgs/Header header\nfloat64 relative_humidity\nfloat64 variance\n"},
    Definition{"stereo_msgs/DisparityImage",
               "std_msgs/Header header\nsensor_msgs/Image image\nfloat32 f\nfloat32 t\n"
               "sensor_msgs/RegionOfInterest valid_window\nfloat32 min_disparity\nfloat32 max_disparity\n"
               "float32 delta_d\n"},
};

std::string_view fields_of(std::string_view name) {
    const auto* found = std::find_if(definitions.begin(), definitions.end(),
                                     [name](const Definition& definition) { return definition.name == name; });
    if (found == definitions.end()) {
        throw std::out_of_range("no definition of the message " + std::string(name));
    }
    return found->fields;
}

/// Adds the messages that `name` contains to the list, each once.
void add_contained(std::string_view name, std::vector<std::string_view>& list) {
    for (const std::string_view line : base::split(fields_of(name), '\n')) {
        const std::string_view type = line.substr(0, line.find_first_of(" ["));
        if (type.find('/') != std::string_view::npos && std::find(list.begin(), list.end(), type) == list.end()) {
            list.push_back(type);
            add_contained(type, list);
        }
    }
}

}  // namespace

std::string ros2msg(std::string_view name) {
    std::string text(fields_of(name));
    std::vector<std::string_view> contained;
    add_contained(name, contained);
    for (const std::string_view other : contained) {
        text += std::string(80, '=') + "\nMSG: " + std::string(other) + "\n" + std::string(fields_of(other));
    }
    return text;
}

std::string schema_name(std::string_view name) {
    const std::size_t slash = name.find('/');
    return std::string(name.substr(0, slash)) + "/msg" + std::string(name.substr(slash));
}

std::string status_schema() {
    json::Json schema = json::schema_of(*v1::Status::descriptor());
    schema["title"] = "disparityd.Status";
    return schema.dump();
}

}  // namespace disparityd::foxglove
