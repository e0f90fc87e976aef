// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace disparityd::formats {

/// Kinds of records, as the format numbers them.
enum class McapOpcode : std::uint8_t {
    header = 1,
    footer = 2,
    schema = 3,
    channel = 4,
    message = 5,
    chunk = 6,
    message_index = 7,
    chunk_index = 8,
    attachment = 9,
    attachment_index = 10,
    statistics = 11,
    metadata = 12,
    metadata_index = 13,
    summary_offset = 14,
    data_end = 15,
};

inline constexpr std::string_view mcap_magic{"\x89MCAP0\r\n", 8};
inline constexpr std::size_t mcap_record_head = 9;  ///< bytes before a record's content: kind, length

/// Takes the fields of a record one after the other; texts and bytes are views. Each throws std::runtime_error where
/// the record is too short.
class McapFields {
public:
    explicit McapFields(std::span<const std::uint8_t> content) : rest_(content) {}

    std::uint64_t number(std::size_t size);
    std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    std::uint64_t u64() { return number(8); }
    std::string_view text();  ///< behind a length of 32 bits
    std::span<const std::uint8_t> bytes(std::uint64_t size);
    std::span<const std::uint8_t> rest() const { return rest_; }

private:
    std::span<const std::uint8_t> rest_;
};

/// What the messages of some channels look like.
struct McapSchema {
    std::string name;                         ///< "sensor_msgs/msg/Image"
    std::string encoding;                     ///< "ros2msg"; how `text` is written
    std::shared_ptr<const std::string> text;  ///< never null; copies share it

    bool operator==(const McapSchema& other) const {
        return name == other.name && encoding == other.encoding && *text == *other.text;
    }
};

/// A stream of messages.
struct McapChannel {
    std::uint16_t schema = 0;  ///< 0: none
    std::string topic;
    std::string message_encoding;  ///< "cdr"

    bool operator==(const McapChannel&) const = default;
};

struct McapMessage {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::uint64_t log_ns = 0;      ///< when it was recorded
    std::uint64_t publish_ns = 0;  ///< when it was sent
    std::span<const std::uint8_t> data;
};

/// Reads a message; its data are a view.
McapMessage mcap_message(std::span<const std::uint8_t> content);

/// The schemas and channels that were read so far. Files repeat them.
class McapDefinitions {
public:
    /// Takes a record of a schema or a channel; returns false for one of another kind. Throws std::runtime_error for
    /// one that contradicts an earlier one, for the schema number 0, and where all together have more than 16 MiB.
    bool take(McapOpcode opcode, std::span<const std::uint8_t> content);

    const std::map<std::uint16_t, McapSchema>& schemas() const { return schemas_; }
    const std::map<std::uint16_t, McapChannel>& channels() const { return channels_; }

private:
    void add_schema(std::span<const std::uint8_t> content);
    void add_channel(std::span<const std::uint8_t> content);
    template <typename Definition>
    void add(std::map<std::uint16_t, Definition>& known, std::uint16_t id, Definition definition, std::size_t bytes,
             const char* kind);

    std::map<std::uint16_t, McapSchema> schemas_;
    std::map<std::uint16_t, McapChannel> channels_;
    std::size_t bytes_ = 0;
};

}  // namespace disparityd::formats
