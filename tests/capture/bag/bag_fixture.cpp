// SPDX-License-Identifier: Apache-2.0
#include "tests/capture/bag/bag_fixture.h"

#include "formats/cdr_writer.h"
#include "formats/ros_definitions.h"
#include "tests/formats/ros1_writer.h"

namespace disparityd::test {
namespace {

using formats::CdrWriter;

constexpr std::string_view header_definition = R"(
================================================================================
MSG: std_msgs/Header
# when and where
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
)";

constexpr std::string_view image_definition = R"(# an image
std_msgs/Header header # of the camera
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
)";

constexpr std::string_view compressed_definition = R"(std_msgs/Header header
string format
uint8[] data
)";

constexpr std::string_view info_definition = R"(std_msgs/Header header
uint32 height
uint32 width
string distortion_model
float64[] d
float64[9]  k # 3x3
float64[9]  r
float64[12] p
uint32 binning_x
uint32 binning_y
RegionOfInterest roi
================================================================================
MSG: sensor_msgs/RegionOfInterest
uint32 x_offset
uint32 y_offset
uint32 height
uint32 width
bool do_rectify
)";

constexpr std::string_view imu_definition = R"(std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
================================================================================
MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

CdrWriter begin(std::int64_t stamp_ns, std::string_view frame = "camera") {
    constexpr std::int64_t second_ns = 1'000'000'000;
    CdrWriter cdr;
    cdr.i32(static_cast<std::int32_t>(stamp_ns / second_ns)).u32(static_cast<std::uint32_t>(stamp_ns % second_ns));
    cdr.text(frame);
    return cdr;
}

std::span<const std::uint8_t> bytes_of(std::string_view text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string ros1_number(std::int64_t value) {
    return Ros1Writer::u32(static_cast<std::uint64_t>(value));
}

std::string ros1_begin(std::int64_t stamp_ns) {
    constexpr std::int64_t second_ns = 1'000'000'000;
    return ros1_number(7) + ros1_number(stamp_ns / second_ns) + ros1_number(stamp_ns % second_ns) +
           Ros1Writer::text("cam");
}

}  // namespace

CameraInfoFields CameraInfoFields::right_of(double baseline_m) const {
    CameraInfoFields right = *this;
    right.p[3] = -p[0] * baseline_m;
    return right;
}

std::uint16_t BagWriter::channel(const std::string& topic, std::string_view type, std::string_view definition) {
    const auto known = channels_.find(topic);
    if (known != channels_.end()) {
        return known->second;
    }
    const std::string text = std::string(definition) + std::string(header_definition);
    const std::uint16_t id = writer_.channel(writer_.schema(type, "ros2msg", text), topic);
    channels_.emplace(topic, id);
    return id;
}

void BagWriter::message(std::uint16_t channel, std::int64_t stamp_ns, const std::string& data) {
    writer_.message(channel, sequence_++, static_cast<std::uint64_t>(stamp_ns), data);
}

void BagWriter::image(const std::string& topic, std::int64_t stamp_ns, const cv::Mat& pixels,
                      const std::string& encoding, int gap) {
    const std::uint16_t id = channel(topic, "sensor_msgs/msg/Image", image_definition);
    const std::size_t row = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
    std::string data;
    for (int y = 0; y < pixels.rows; ++y) {
        data += std::string(pixels.ptr<char>(y), row) + std::string(static_cast<std::size_t>(gap), 'x');
    }
    CdrWriter cdr = begin(stamp_ns);
    cdr.u32(static_cast<std::uint32_t>(pixels.rows)).u32(static_cast<std::uint32_t>(pixels.cols)).text(encoding);
    cdr.u8(0).u32(static_cast<std::uint32_t>(row) + static_cast<std::uint32_t>(gap)).u8_sequence(bytes_of(data));
    message(id, stamp_ns, cdr.take());
}

void BagWriter::compressed(const std::string& topic, std::int64_t stamp_ns, const std::string& format,
                           std::string_view file) {
    const std::uint16_t id = channel(topic, "sensor_msgs/msg/CompressedImage", compressed_definition);
    CdrWriter cdr = begin(stamp_ns);
    cdr.text(format).u8_sequence(bytes_of(file));
    message(id, stamp_ns, cdr.take());
}

void BagWriter::camera_info(const std::string& topic, std::int64_t stamp_ns, const CameraInfoFields& fields) {
    const std::uint16_t id = channel(topic, "sensor_msgs/msg/CameraInfo", info_definition);
    CdrWriter cdr = begin(stamp_ns);
    cdr.u32(static_cast<std::uint32_t>(fields.height)).u32(static_cast<std::uint32_t>(fields.width)).text(fields.model);
    cdr.f64_sequence(fields.distortion).f64_array(fields.k).f64_array(fields.r).f64_array(fields.p);
    cdr.u32(fields.binning).u32(fields.binning);
    for (const unsigned number : fields.roi) {
        cdr.u32(number);
    }
    message(id, stamp_ns, cdr.boolean(false).take());
}

void BagWriter::imu(const std::string& topic, std::int64_t stamp_ns, double turn, double pull) {
    const std::uint16_t id = channel(topic, "sensor_msgs/msg/Imu", imu_definition);
    CdrWriter cdr = begin(stamp_ns, "imu");
    const std::array<double, 9> covariance{};
    cdr.f64_array(std::array{0.0, 0.0, 0.0, 1.0}).f64_array(covariance);
    cdr.f64_array(std::array{turn, 2 * turn, 3 * turn}).f64_array(covariance);
    cdr.f64_array(std::array{pull, 2 * pull, 3 * pull}).f64_array(covariance);
    message(id, stamp_ns, cdr.take());
}

void BagWriter::transforms(std::int64_t stamp_ns, const std::vector<TransformFields>& transforms) {
    constexpr std::string_view type = "tf2_msgs/msg/TFMessage";
    const std::uint16_t id = channel("/tf_static", type, formats::published_definition(type));
    CdrWriter cdr;
    cdr.length(transforms.size());
    for (const TransformFields& transform : transforms) {
        cdr.i32(0).u32(0).text(transform.parent).text(transform.child);
        cdr.f64_array(transform.translation_m).f64_array(transform.rotation);
    }
    message(id, stamp_ns, cdr.take());
}

const std::string_view ros1_image_type =
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
    "uint8[] data\n================================================================================\n"
    "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";

const std::string_view ros1_camera_info_type =
    "std_msgs/Header header\nuint32 height\nuint32 width\nstring distortion_model\nfloat64[] D\nfloat64[9] K\n"
    "float64[9] R\nfloat64[12] P\nuint32 binning_x\nuint32 binning_y\nsensor_msgs/RegionOfInterest roi\n"
    "================================================================================\n"
    "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
    "================================================================================\n"
    "MSG: sensor_msgs/RegionOfInterest\nuint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
    "bool do_rectify\n";

std::string ros1_image(std::int64_t stamp_ns, const cv::Mat& grey) {
    const std::string_view pixels(grey.ptr<char>(),
                                  static_cast<std::size_t>(grey.rows) * static_cast<std::size_t>(grey.cols));
    return ros1_begin(stamp_ns) + ros1_number(grey.rows) + ros1_number(grey.cols) + Ros1Writer::text("mono8") +
           Ros1Writer::u8(0) + ros1_number(grey.cols) + Ros1Writer::text(pixels);
}

std::string ros1_camera_info(std::int64_t stamp_ns, const CameraInfoFields& fields) {
    const auto reals = [](std::span<const double> numbers) {
        return std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
    };
    std::string message = ros1_begin(stamp_ns) + ros1_number(fields.height) + ros1_number(fields.width) +
                          Ros1Writer::text(fields.model) + Ros1Writer::u32(fields.distortion.size()) +
                          reals(fields.distortion) + reals(fields.k) + reals(fields.r) + reals(fields.p) +
                          Ros1Writer::u32(fields.binning) + Ros1Writer::u32(fields.binning);
    for (const unsigned number : fields.roi) {
        message += Ros1Writer::u32(number);
    }
    return message + Ros1Writer::u8(0);
}

}  // namespace disparityd::test
