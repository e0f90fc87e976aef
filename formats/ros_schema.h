// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace disparityd::formats {

enum class RosKind : std::uint8_t {
    boolean,
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    float32,
    float64,
    text,
    wide_text,
    message,  ///< another definition
};

struct RosField {
    enum class Count : std::uint8_t { one, fixed, sequence };

    std::string name;
    RosKind kind = RosKind::boolean;
    Count count = Count::one;
    std::size_t size = 0;        ///< of a fixed array
    std::size_t definition = 0;  ///< of a message: its place in RosSchema::definitions
};

/// The fields of one type of message, in their order.
struct RosDefinition {
    std::string name;  ///< "sensor_msgs/Image"
    std::vector<RosField> fields;
};

/// A type of message with all that it consists of. The first definition is the type itself.
struct RosSchema {
    std::vector<RosDefinition> definitions;
};

/// Reads the text by which recordings describe a type of ROS 2 ("ros2msg"): its definition as in a .msg file, then,
/// behind lines of "=" and "MSG: package/Type", those of the types that it has. `name` is the type's,
/// "sensor_msgs/msg/Image". Times and durations are known where their definition is missing. Throws
/// std::runtime_error with one line for what is no such text, for a type that is not defined, and for types within
/// each other more than 16 deep.
RosSchema parse_ros_schema(std::string_view name, std::string_view text);

}  // namespace disparityd::formats
