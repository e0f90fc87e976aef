// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mcap_fields.h"

namespace disparityd::formats {

/// How an MCAP file is written.
struct McapLayout {
    std::string profile = "ros2";
    std::size_t chunk_bytes = std::size_t{1} << 20U;  ///< a chunk ends with the message that makes it so long
    std::uint64_t chunk_ns = 1'000'000'000;           ///< and before one that is so much later than its first
};

/// Writes an MCAP file (https://mcap.dev/spec) from its begin to its end: chunks packed by zstd, each with a checksum
/// and the indexes of its messages; at the end a summary with schemas, channels, statistics and the indexes of all
/// chunks. The same messages give the same bytes, with the same version of zstd. It holds one chunk, packed and
/// unpacked, and some hundred bytes for each one before. One thread uses an object at a time.
class McapStreamWriter {
public:
    /// Takes bytes that follow those before. Each call but the last ends where a reader may stop: behind a chunk with
    /// its indexes. What it throws comes out of the function that called it, and the writer is of no use afterwards.
    using Sink = std::function<void(std::string_view bytes)>;

    explicit McapStreamWriter(Sink sink, McapLayout layout = {});

    /// Add a definition and return its number. `schema` 0: the messages have none. Throw std::length_error beyond
    /// 65,535 of them, add_channel() also std::out_of_range for a schema that there is not.
    std::uint16_t add_schema(std::string_view name, std::string_view encoding, std::string_view text);
    std::uint16_t add_channel(std::uint16_t schema, std::string_view topic, std::string_view encoding);

    /// Appends a message. Throws std::out_of_range for a channel that there is not, std::length_error for one that no
    /// reader of this project would take (mcap_most_bytes).
    void write(const McapMessage& message);

    /// Ends the file. Nothing is written afterwards.
    void finish();

    // What the sink has taken: messages of a chunk count once all of it is there, those of a chunk at hand do not.
    std::uint64_t messages() const { return messages_; }
    std::uint64_t bytes() const { return position_; }
    const std::map<std::uint16_t, std::uint64_t>& messages_of_channels() const { return counts_; }

private:
    struct Span {
        std::uint64_t first_ns = 0;
        std::uint64_t last_ns = 0;
        bool any = false;

        void add(std::uint64_t time_ns);
    };

    using Entries = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< time, offset within the chunk

    void define(McapOpcode opcode, const std::string& content);
    void hand_over();
    void end_chunk();
    void pack_chunk();
    std::string write_message_indexes();
    void write_group(McapOpcode opcode, const std::vector<std::string>& contents);
    std::string statistics() const;

    const Sink sink_;
    const McapLayout layout_;
    std::string out_;             ///< what the sink gets next
    std::uint64_t position_ = 0;  ///< of the file, where out_ begins
    std::uint32_t checksum_ = 0;  ///< of all bytes before out_
    std::string chunk_;           ///< records of the chunk at hand
    Span chunk_span_;
    std::map<std::uint16_t, Entries> entries_;  ///< of the chunk at hand
    std::vector<std::string> schemas_, channels_, chunk_indexes_, summary_offsets_;
    std::map<std::uint16_t, std::uint64_t> counts_;  ///< of whole chunks, as messages_
    Span span_;
    std::uint64_t messages_ = 0;
};

}  // namespace disparityd::formats
