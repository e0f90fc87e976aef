// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace disparityd::formats {

/// What a bag may have of names and definitions, as an MCAP file may: more is no bag of a robot, and would fill the
/// memory.
constexpr std::size_t most_bag_text_bytes = std::size_t{16} << 20U;

/// A stream of messages of one type in a bag.
struct BagConnection {
    std::string topic;
    std::string type;                 ///< "sensor_msgs/msg/Image", of ROS 1, too
    std::string encoding;             ///< of messages: "cdr", "ros1"
    std::string definition_encoding;  ///< how `definition` is written: "ros2msg", "ros1msg"
    /// Of the type, never null; empty where the file has none. Connections of one type share it, as a file may have
    /// many of them.
    std::shared_ptr<const std::string> definition = std::make_shared<const std::string>();
    std::optional<std::uint64_t> messages{};  ///< how many there are, where the file says so
};

/// Reads the messages of one file of a bag of ROS 1 or 2 in the order in which they lie there. It holds a part of at
/// most 256 MiB at a time. One thread uses an object at a time. next() throws std::runtime_error with one line that
/// begins with the path: where the file is damaged or was cut off. All that is whole before was then returned.
class RosBag {
public:
    struct Message {
        std::uint32_t connection = 0;
        std::string_view topic;              ///< valid until the next call, as `data`
        std::uint64_t log_ns = 0;            ///< when it was recorded, ns since 1970
        std::span<const std::uint8_t> data;  ///< as BagConnection::encoding says; may be packed by zstd
    };

    RosBag() = default;
    virtual ~RosBag() = default;
    RosBag(const RosBag&) = delete;
    RosBag& operator=(const RosBag&) = delete;

    /// Returns what is known so far: all there is where lists_all(). An entry stays as and where it is.
    virtual const std::map<std::uint32_t, BagConnection>& connections() const = 0;
    virtual bool lists_all() const = 0;

    /// Reads the next message; false after the last one.
    virtual bool next(Message& message) = 0;

    /// Returns how many bytes of the file were read.
    virtual std::uint64_t position() const = 0;
};

/// Opens a file by its first bytes, or by the ending of its name where these are none of a bag: MCAP, .db3 (SQLite),
/// .bag (ROS 1). Throws std::invalid_argument with one line for what is no bag, std::runtime_error for one that is
/// damaged in a place that all of it needs, or that the system does not let us read.
std::unique_ptr<RosBag> open_ros_bag(const std::string& path);

}  // namespace disparityd::formats
