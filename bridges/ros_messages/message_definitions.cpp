// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros_messages/message_definitions.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <vector>

#include "base/words.h"

namespace disparityd::ros {
namespace {

struct Definition {
    std::string_view name;
    std::string_view fields;
    std::string_view hash = {};
};

constexpr std::array definitions{
    Definition{"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    Definition{"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    Definition{"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    Definition{"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    Definition{"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    Definition{"geometry_msgs/TransformStamped",
               "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    Definition{"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n",
               "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
    Definition{"sensor_msgs/RegionOfInterest",
               "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\nbool do_rectify\n"},
    Definition{"sensor_msgs/Image",
               "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
               "uint8[] data\n",
               "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
    Definition{"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n",
               "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
    Definition{"sensor_msgs/CameraInfo",
               "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] d\n"
               "float64[9] k\nfloat64[9] r\nfloat64[12] p\nuint32 binning_x\nuint32 binning_y\n"
               "sensor_msgs/RegionOfInterest roi\n",
               "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
    Definition{"sensor_msgs/PointField",
               "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\nuint8 UINT32=6\n"
               "uint8 FLOAT32=7\nuint8 FLOAT64=8\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    Definition{"sensor_msgs/PointCloud2",
               "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
               "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
               "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
    Definition{"sensor_msgs/LaserScan",
               "std_msgs/Header header\nfloat32 angle_min\nfloat32 angle_max\nfloat32 angle_increment\n"
               "float32 time_increment\nfloat32 scan_time\nfloat32 range_min\nfloat32 range_max\nfloat32[] ranges\n"
               "float32[] intensities\n",
               "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
    Definition{"sensor_msgs/Imu",
               "std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\n"
               "geometry_msgs/Vector3 angular_velocity\nfloat64[9] angular_velocity_covariance\n"
               "geometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n",
               "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
    Definition{"sensor_msgs/MagneticField",
               "std_msgs/Header header\ngeometry_msgs/Vector3 magnetic_field\nfloat64[9] magnetic_field_covariance\n",
               "RIHS01_e80f32f56a20486c9923008fc1a1db07bbb273cbbf6a5b3bfa00835ee00e4dff"},
    Definition{"sensor_msgs/Temperature", "std_msgs/Header header\nfloat64 temperature\nfloat64 variance\n",
               "RIHS01_72514a14126ab9f8a9abec974c78e5610a367b59db5da355ff1fb982d5bad4b8"},
    Definition{"sensor_msgs/FluidPressure", "std_msgs/Header header\nfloat64 fluid_pressure\nfloat64 variance\n",
               "RIHS01_22dfb2b145a0bd5a31a1ac3882a1b32148b51d9b2f3bab250290d66f3595bc32"},
    Definition{"sensor_msgs/RelativeHumidity", "std_msgs/Header header\nfloat64 relative_humidity\nfloat64 variance\n",
               "RIHS01_8687c99b4fb393cb2e545e407b5ea7fd0b5d8960bcd849a0f86c544740138839"},
    Definition{"stereo_msgs/DisparityImage",
               "std_msgs/Header header\nsensor_msgs/Image image\nfloat32 f\nfloat32 t\n"
               "sensor_msgs/RegionOfInterest valid_window\nfloat32 min_disparity\nfloat32 max_disparity\n"
               "float32 delta_d\n",
               "RIHS01_1ec1ff6b5bace919e4544a37f2d96ead9f81783701b7b7a4d97a09325ecf2711"},
    Definition{"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    Definition{"diagnostic_msgs/DiagnosticStatus",
               "byte OK=0\nbyte WARN=1\nbyte ERROR=2\nbyte STALE=3\nbyte level\nstring name\nstring message\n"
               "string hardware_id\ndiagnostic_msgs/KeyValue[] values\n"},
    Definition{"diagnostic_msgs/DiagnosticArray", "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n",
               "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
    Definition{"rosgraph_msgs/Clock", "builtin_interfaces/Time clock\n",
               "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"},
    Definition{"rmw_dds_common/Gid", "uint8[16] data\n"},
    Definition{"rmw_dds_common/NodeEntitiesInfo",
               "string node_namespace\nstring node_name\nrmw_dds_common/Gid[] reader_gid_seq\n"
               "rmw_dds_common/Gid[] writer_gid_seq\n"},
    Definition{"rmw_dds_common/ParticipantEntitiesInfo",
               "rmw_dds_common/Gid gid\nrmw_dds_common/NodeEntitiesInfo[] node_entities_info_seq\n",
               "RIHS01_48f130c42f68f6d35fb1f48b6635c7e3b25055b5e135616887ec32ea30caf418"},
};

const Definition& definition_of(std::string_view name) {
    const auto* found = std::find_if(definitions.begin(), definitions.end(),
                                     [name](const Definition& definition) { return definition.name == name; });
    if (found == definitions.end()) {
        throw std::out_of_range("no definition of the message " + std::string(name));
    }
    return *found;
}

/// Adds the messages that `name` contains to the list, each once.
void add_contained(std::string_view name, std::vector<std::string_view>& list) {
    for (const std::string_view line : base::split(definition_of(name).fields, '\n')) {
        const std::string_view type = line.substr(0, line.find_first_of(" ["));
        if (type.find('/') != std::string_view::npos && std::find(list.begin(), list.end(), type) == list.end()) {
            list.push_back(type);
            add_contained(type, list);
        }
    }
}

}  // namespace

std::string ros2msg(std::string_view name) {
    std::string text(definition_of(name).fields);
    std::vector<std::string_view> contained;
    add_contained(name, contained);
    for (const std::string_view other : contained) {
        text += std::string(80, '=') + "\nMSG: " + std::string(other) + "\n" + std::string(definition_of(other).fields);
    }
    return text;
}

std::string schema_name(std::string_view name) {
    const std::size_t slash = name.find('/');
    return std::string(name.substr(0, slash)) + "/msg" + std::string(name.substr(slash));
}

std::string dds_type_name(std::string_view name) {
    const std::size_t slash = name.find('/');
    return std::string(name.substr(0, slash)) + "::msg::dds_::" + std::string(name.substr(slash + 1)) + "_";
}

std::string_view type_hash(std::string_view name) {
    return definition_of(name).hash;
}

}  // namespace disparityd::ros
