// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/ros_schema.h"

namespace disparityd::formats {

/// How the fields of a message lie in its bytes.
enum class RosEncoding : std::uint8_t {
    cdr,   ///< of ROS 2
    ros1,  ///< little endian, without gaps
};

/// The fields of one message of ROS, read by its schema. A field within another message has its path,
/// "header.stamp.sec". Numbers are doubles, arrays of 8 bits are bytes. Texts and bytes are views of the message, which
/// must live as long. Those of an array of messages have the number of the element, "transforms.0.child_frame_id":
/// of the first 64, and of at most about 10000 fields. Arrays of texts, and those of more than 4096 numbers, are passed
/// over.
class RosMessage {
public:
    using Value = std::variant<double, std::string_view, std::span<const std::uint8_t>, std::vector<double>>;

    /// Throws std::runtime_error with one line where the bytes are not what the schema says. The line does not say
    /// which message it is.
    RosMessage(const RosSchema& schema, std::span<const std::uint8_t> bytes, RosEncoding encoding = RosEncoding::cdr);

    /// Return a field. Throw std::runtime_error where there is none of this name and kind.
    double number(std::string_view path) const;
    std::int64_t integer(std::string_view path) const;  ///< a whole number of at most 32 bits
    std::string_view text(std::string_view path) const;
    std::span<const std::uint8_t> bytes(std::string_view path) const;
    const std::vector<double>& numbers(std::string_view path) const;

    bool has(std::string_view path) const { return fields_.find(path) != fields_.end(); }
    const std::map<std::string, Value, std::less<>>& fields() const { return fields_; }

private:
    template <typename Kind>
    const Kind& get(std::string_view path, const char* kind) const;

    std::map<std::string, Value, std::less<>> fields_;
};

}  // namespace disparityd::formats
