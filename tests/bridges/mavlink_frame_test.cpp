// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/mavlink_frame.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "bridges/mavlink/attitude.h"
#include "bridges/mavlink/heartbeat.h"
#include "bridges/mavlink/obstacle_message.h"

namespace disparityd::mavlink {
namespace {

std::uint16_t crc_of(const std::string& text, std::uint16_t before = crc_start) {
    return crc(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()), before);
}

/// A field as the published definition lists it.
struct Field {
    std::string type;
    std::string name;
    std::size_t array = 0;  ///< elements; 0: no array
    bool extension = false;

    std::size_t element() const {
        return type == "uint64_t" ? 8U : type == "uint32_t" || type == "float" ? 4U : type == "uint16_t" ? 2U : 1U;
    }
    std::size_t bytes() const { return element() * std::max<std::size_t>(array, 1); }
};

/// Returns CRC_EXTRA by MAVLink's rule: over the name and the fields in the order of the wire, larger elements first,
/// without extensions.
std::uint8_t crc_extra(const std::string& name, std::vector<Field> fields) {
    std::erase_if(fields, [](const Field& field) { return field.extension; });
    std::stable_sort(fields.begin(), fields.end(),
                     [](const Field& a, const Field& b) { return a.element() > b.element(); });
    std::uint16_t sum = crc_of(name + ' ');
    for (const Field& field : fields) {
        sum = crc_of(field.type + ' ' + field.name + ' ', sum);
        if (field.array > 0) {
            sum = crc_of(std::string(1, static_cast<char>(field.array)), sum);
        }
    }
    return static_cast<std::uint8_t>((sum & 0xff) ^ (sum >> 8));
}

std::size_t length(const std::vector<Field>& fields) {
    std::size_t bytes = 0;
    for (const Field& field : fields) {
        bytes += field.bytes();
    }
    return bytes;
}

// In the order of the published definitions: minimal.xml, common.xml, ardupilotmega.xml.
const std::vector<Field> heartbeat_fields{{"uint8_t", "type"},          {"uint8_t", "autopilot"},
                                          {"uint8_t", "base_mode"},     {"uint32_t", "custom_mode"},
                                          {"uint8_t", "system_status"}, {"uint8_t", "mavlink_version"}};
const std::vector<Field> obstacle_distance_fields{
    {"uint64_t", "time_usec"},         {"uint8_t", "sensor_type"},         {"uint16_t", "distances", 72},
    {"uint8_t", "increment"},          {"uint16_t", "min_distance"},       {"uint16_t", "max_distance"},
    {"float", "increment_f", 0, true}, {"float", "angle_offset", 0, true}, {"uint8_t", "frame", 0, true}};
const std::vector<Field> obstacle_distance_3d_fields{{"uint32_t", "time_boot_ms"},
                                                     {"uint8_t", "sensor_type"},
                                                     {"uint8_t", "frame"},
                                                     {"uint16_t", "obstacle_id"},
                                                     {"float", "x"},
                                                     {"float", "y"},
                                                     {"float", "z"},
                                                     {"float", "min_distance"},
                                                     {"float", "max_distance"}};

const std::vector<Field> attitude_fields{
    {"uint32_t", "time_boot_ms"}, {"float", "roll"},       {"float", "pitch"},   {"float", "yaw"},
    {"float", "rollspeed"},       {"float", "pitchspeed"}, {"float", "yawspeed"}};
const std::vector<Field> command_long_fields{{"uint8_t", "target_system"}, {"uint8_t", "target_component"},
                                             {"uint16_t", "command"},      {"uint8_t", "confirmation"},
                                             {"float", "param1"},          {"float", "param2"},
                                             {"float", "param3"},          {"float", "param4"},
                                             {"float", "param5"},          {"float", "param6"},
                                             {"float", "param7"}};

TEST(MavlinkFrame, CrcIsMcrf4xx) {
    EXPECT_EQ(crc_of("123456789"), 0x6f91);  // the check value of that CRC
    EXPECT_EQ(crc_of(""), 0xffff);
    EXPECT_EQ(crc_of("6789", crc_of("12345")), 0x6f91);
}

TEST(MavlinkFrame, KindsAreThoseOfTheDefinition) {
    EXPECT_EQ(heartbeat_kind.crc_extra, crc_extra("HEARTBEAT", heartbeat_fields));
    EXPECT_EQ(obstacle_distance_kind.crc_extra, crc_extra("OBSTACLE_DISTANCE", obstacle_distance_fields));
    EXPECT_EQ(obstacle_distance_3d_kind.crc_extra, crc_extra("OBSTACLE_DISTANCE_3D", obstacle_distance_3d_fields));
    EXPECT_EQ(attitude_kind.crc_extra, crc_extra("ATTITUDE", attitude_fields));
    EXPECT_EQ(command_long_kind.crc_extra, crc_extra("COMMAND_LONG", command_long_fields));
    EXPECT_EQ(attitude_kind.length, length(attitude_fields));
    EXPECT_EQ(command_long_kind.length, length(command_long_fields));
    EXPECT_EQ(heartbeat_kind.length, length(heartbeat_fields));
    EXPECT_EQ(obstacle_distance_kind.length, length(obstacle_distance_fields));
    EXPECT_EQ(obstacle_distance_3d_kind.length, length(obstacle_distance_3d_fields));
}

TEST(MavlinkFrame, HasTheBytesOfAHandMadeHeartbeat) {
    FrameWriter writer(1, 196);
    const std::vector<std::uint8_t> wanted{0xfd, 9,   0, 0, 0,  1, 196, 0, 0, 0,  // header
                                           0,    0,   0, 0, 18, 8, 0,   4, 3,     // payload
                                           0xf4, 0x9a};                           // CRC
    EXPECT_EQ(writer.frame(heartbeat(SystemState::active)), wanted);
}

TEST(MavlinkFrame, LeavesOutZerosAtTheEndButNotTheFirstByte) {
    FrameWriter writer(7, 196);
    writer.frame(heartbeat(SystemState::boot));
    const Message zeros{obstacle_distance_3d_kind, std::vector<std::uint8_t>(28)};
    const std::vector<std::uint8_t> wanted{0xfd, 1, 0, 0, 1, 7, 196, 0x1d, 0x2b, 0, 0, 0xaa, 0xd4};
    EXPECT_EQ(writer.frame(zeros), wanted);
    Message one = zeros;
    one.payload[26] = 5;
    EXPECT_EQ(writer.frame(one)[1], 27);
}

TEST(MavlinkFrame, CountsFromZeroTo255AndOn) {
    FrameWriter writer(1, 1);
    for (int i = 0; i < 600; ++i) {
        EXPECT_EQ(writer.frame(heartbeat(SystemState::boot))[4], i % 256);
    }
}

TEST(MavlinkFrame, RefusesAPayloadOfAnotherLength) {
    FrameWriter writer(1, 1);
    EXPECT_THROW(writer.frame({heartbeat_kind, std::vector<std::uint8_t>(8)}), std::logic_error);
    EXPECT_THROW(writer.frame({{1, 1, 256}, std::vector<std::uint8_t>(256)}), std::logic_error);
    EXPECT_THROW(writer.frame({{1, 1, 0}, {}}), std::logic_error);
}

TEST(MavlinkFrame, WritesFieldsLittleEndian) {
    std::vector<std::uint8_t> bytes;
    PayloadWriter(bytes).u8(1).u16(0x0302).u32(0x07060504).u64(0x0f0e0d0c0b0a0908).f32(1.0F);
    EXPECT_EQ(bytes, (std::vector<std::uint8_t>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 0, 0, 0x80, 0x3f}));
}

}  // namespace
}  // namespace disparityd::mavlink
