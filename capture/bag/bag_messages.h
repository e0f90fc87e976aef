// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/ros_bag.h"
#include "formats/ros_message.h"

namespace disparityd::capture {

/// A topic of a bag.
struct BagTopic {
    std::string name;
    std::string type;                       ///< "sensor_msgs/msg/Image"
    std::optional<std::uint64_t> messages;  ///< how many there are, where the bag says so
};

/// Reads the messages of a bag of ROS 1 or 2: one file, or those of a folder with metadata.yaml one after the other.
/// One thread uses an object at a time. The constructor throws std::invalid_argument with one line for what is no bag
/// that can be read; all functions throw std::runtime_error with one line for damage.
class BagMessages {
public:
    struct Message {
        std::string_view topic;  ///< valid until the next call
        std::int64_t log_ns = 0;
        std::span<const std::uint8_t> data;  ///< valid until the next call
    };

    explicit BagMessages(const std::string& path);

    /// Returns the topics that are known: all of them where has_all_topics(), else those of the messages so far.
    std::vector<BagTopic> topics() const;
    bool has_all_topics() const;

    /// Reads the next message; false after the last one of the last file.
    bool next(Message& message);

    /// Reads the message that next() returned last by the schema of its topic. Valid until the next call.
    formats::RosMessage decode(const Message& message);

    /// Throws std::runtime_error for the message that next() returned last: file, topic, what is wrong with it.
    [[noreturn]] void fail(const Message& message, const std::string& what) const;

    /// Returns how many bytes were read of all files.
    std::uint64_t position() const { return before_ + reader_->position(); }

private:
    /// How to read messages of a type.
    struct Type {
        formats::RosSchema schema;
        formats::RosEncoding encoding;
    };

    /// What of a connection says how its messages are read. Borrowed from the reader.
    using TypeText = std::array<std::string_view, 4>;

    void open(std::size_t file);
    const Type& type_of(std::uint32_t connection);
    static Type parse(const formats::BagConnection& connection);
    void unpack(std::span<const std::uint8_t>& data);

    std::vector<std::string> files_;
    std::vector<BagTopic> earlier_;  ///< of the files before this one
    std::size_t file_ = 0;
    std::uint64_t before_ = 0;  ///< bytes of the files before this one
    std::unique_ptr<formats::RosBag> reader_;
    std::map<TypeText, Type> types_;  ///< of this file
    std::map<std::uint32_t, const Type*> type_of_connection_;
    std::uint32_t connection_ = 0;        ///< of the last message
    std::vector<std::uint8_t> unpacked_;  ///< the last message, where it was packed
};

}  // namespace disparityd::capture
