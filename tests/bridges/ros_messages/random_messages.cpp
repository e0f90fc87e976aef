// SPDX-License-Identifier: Apache-2.0
//
// Prints random and extreme frames and samples with the messages that are made of them, for decode_messages.cjs: each a
// line of JSON. The first line has the definitions. The same numbers each time.
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include <nlohmann/json.hpp>

#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/message_definitions.h"
#include "bridges/ros_messages/transform_message.h"

namespace {

using namespace disparityd;
using disparity::Product;
using nlohmann::json;

constexpr std::uint32_t last_content = 27;

std::mt19937 random_bits(45);

double random_between(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_bits()) / 4294967296.0);
}

std::uint32_t random_below(std::uint32_t limit) {
    return static_cast<std::uint32_t>(random_bits() % limit);
}

template <typename Bytes>
std::string hexadecimal(const Bytes& bytes) {
    std::string text;
    for (const auto byte : bytes) {
        constexpr const char* digits = "0123456789abcdef";
        const auto value = static_cast<unsigned char>(byte);
        text += {digits[value >> 4], digits[value & 15]};
    }
    return text;
}

/// Returns bytes that are random, or all one value.
std::vector<std::uint8_t> random_bytes(std::size_t size) {
    const std::uint32_t kind = random_below(8);
    std::vector<std::uint8_t> bytes(size, kind == 0 ? 0 : kind == 1 ? 255 : kind == 2 ? 128 : 1);
    if (kind > 3) {
        for (std::uint8_t& byte : bytes) {
            byte = static_cast<std::uint8_t>(random_bits());
        }
    }
    return bytes;
}

disparity::Frame random_frame() {
    disparity::Frame frame;
    frame.width = 1 + random_below(40);
    frame.height = 1 + random_below(30);
    const bool extreme = random_below(4) == 0;
    // Nanoseconds of before 1970, up to the last second that fits.
    frame.realtime_ns = extreme ? (random_below(2) == 0 ? -1 : 2'147'483'647'999'999'999) : 1'700'000'000'123'456'789;
    frame.f = extreme ? (random_below(2) == 0 ? 0 : 1e-3) : random_between(100, 3000);
    frame.cx = random_between(-50, 90);
    frame.cy = random_between(-50, 90);
    frame.baseline_mm = random_below(6) == 0 ? 0 : random_between(1, 500);
    frame.disparity_offset = random_between(-40, 40);
    frame.d_min = static_cast<std::int32_t>(random_below(64)) - 32;
    frame.disparities = 1 + random_below(256);
    frame.invalid = (frame.d_min - 1) * 16;
    frame.flags = random_below(8) == 0 ? std::uint32_t{disparity::unrectified} : 0;
    for (const auto& [product, bytes] : {std::pair{Product::disparity, 2U},
                                         {Product::confidence, 1U},
                                         {Product::depth, 2U},
                                         {Product::left, 1U},
                                         {Product::left_colour, 3U},
                                         {Product::depth_error, 2U},
                                         {Product::right, 1U},
                                         {Product::right_colour, 3U}}) {
        if (random_below(4) != 0) {
            frame.planes.push_back({product, frame.width, frame.height, bytes,
                                    random_bytes(std::size_t{frame.width} * frame.height * bytes)});
        }
    }
    return frame;
}

json to_json(const disparity::Frame& frame) {
    json planes = json::object();
    for (const disparity::PlaneData& plane : frame.planes) {
        planes[std::to_string(static_cast<std::uint32_t>(plane.product))] = hexadecimal(plane.bytes);
    }
    return {{"width", frame.width},
            {"height", frame.height},
            {"realtime_ns", std::to_string(frame.realtime_ns)},
            {"f", frame.f},
            {"cx", frame.cx},
            {"cy", frame.cy},
            {"baseline_mm", frame.baseline_mm},
            {"offset", frame.disparity_offset},
            {"d_min", frame.d_min},
            {"disparities", frame.disparities},
            {"invalid", frame.invalid},
            {"flags", frame.flags},
            {"planes", planes}};
}

template <typename Encode>
json messages(Encode encode) {
    json list = json::object();
    for (std::uint32_t number = 1; number <= last_content; ++number) {
        if (const std::optional<std::string> message = encode(static_cast<ros::Content>(number))) {
            list[std::to_string(number)] = hexadecimal(*message);
        }
    }
    return list;
}

disparity::SensorSample random_sample() {
    const auto number = [] { return static_cast<float>(random_between(-1e6, 1e6)); };
    disparity::SensorSample sample;
    sample.realtime_ns = 1'700'000'000'000'000'000 + random_below(1'000'000'000);
    sample.inertial = {{number(), number(), number()}, {number(), number(), number()}, number()};
    sample.magnetic_field = {number(), number(), number()};
    sample.environment = {number(), number(), number()};
    sample.eye_temperatures = {number(), number()};
    return sample;
}

json to_json(const disparity::SensorSample& sample) {
    const auto vector = [](const disparity::SensorVector& v) { return json{v.x, v.y, v.z}; };
    return {{"realtime_ns", std::to_string(sample.realtime_ns)},
            {"rate", vector(sample.inertial->angular_velocity)},
            {"acceleration", vector(sample.inertial->acceleration)},
            {"imu_celsius", sample.inertial->celsius},
            {"field", vector(*sample.magnetic_field)},
            {"celsius", sample.environment->celsius},
            {"hectopascal", sample.environment->hectopascal},
            {"humidity", sample.environment->humidity_percent},
            {"left_celsius", sample.eye_temperatures->left_celsius},
            {"right_celsius", sample.eye_temperatures->right_celsius}};
}

void print(const json& line) {
    std::printf("%s\n", line.dump().c_str());
}

json definitions() {
    json list = json::object();
    for (std::uint32_t number = 1; number <= last_content; ++number) {
        const std::string_view name = ros::message_name(static_cast<ros::Content>(number));
        if (!name.empty()) {
            list[std::to_string(number)] = {
                {"name", ros::schema_name(name)}, {"schema", ros::ros2msg(name)}, {"hash", ros::type_hash(name)}};
        }
    }
    const std::string_view graph = "rmw_dds_common/ParticipantEntitiesInfo";
    list["graph"] = {
        {"name", ros::schema_name(graph)}, {"schema", ros::ros2msg(graph)}, {"hash", ros::type_hash(graph)}};
    return list;
}

}  // namespace

int main() {
    ros::Encoding encoding{.cloud = {.most_points = 10000}, .names = {.left = "l", .camera = "c", .imu = "i"}};
    print({{"definitions", definitions()}});
    for (int i = 0; i < 60; ++i) {
        encoding.depth_codec = i % 2 == 0 ? ros::DepthCodec::png : ros::DepthCodec::rvl;
        const disparity::Frame frame = random_frame();
        print({{"frame", to_json(frame)},
               {"messages", messages([&](ros::Content content) { return ros::encode(content, frame, encoding); })}});
        const disparity::SensorSample sample = random_sample();
        print({{"sample", to_json(sample)}, {"messages", messages([&](ros::Content content) {
                                                 return ros::encode(content, sample, encoding.names);
                                             })}});
    }
    return std::ferror(stdout) == 0 && std::fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
