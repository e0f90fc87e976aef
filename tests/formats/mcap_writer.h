// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace disparityd::test {

/// What of the format a file uses. Nothing of it is needed to read the messages in their order.
struct McapFeatures {
    bool chunks = true;
    std::string packing;  ///< of chunks: "", "zstd", "lz4"
    std::size_t chunk_bytes = 1 << 20;
    bool message_index = true;
    bool chunk_index = true;
    bool attachment_index = true;
    bool metadata_index = true;
    bool statistics = true;
    bool summary_offsets = true;
    bool repeated_schemas = true;
    bool repeated_channels = true;
    bool checksums = true;
    bool padding = false;  ///< each record that may have more bytes than the format names has some
};

/// Makes an MCAP file as a text in memory.
class McapWriter {
public:
    explicit McapWriter(McapFeatures features = {}, std::string_view profile = "ros2");

    /// Add a definition and return its number.
    std::uint16_t schema(std::string_view name, std::string_view encoding, std::string_view text);
    std::uint16_t channel(std::uint16_t schema, std::string_view topic, std::string_view encoding = "cdr");

    void message(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns, std::string_view data);
    void attachment(std::string_view name, std::string_view data);
    void metadata(std::string_view name, const std::map<std::string, std::string>& entries);

    /// Ends the file and returns it.
    std::string close();

private:
    struct Group {
        int opcode;
        std::size_t begin;
        std::size_t end;
    };

    void record(std::string& to, int opcode, const std::string& content) const;
    void padded_record(std::string& to, int opcode, std::string content) const;
    void to_data(int opcode, const std::string& content);
    void close_chunk();
    std::string statistics() const;
    std::vector<Group> write_summary();

    const McapFeatures features_;
    std::string file_;
    std::string chunk_;
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_entries_;  ///< time, offset
    std::uint64_t chunk_first_ = 0;
    std::uint64_t chunk_last_ = 0;
    std::vector<std::string> schemas_, channels_, chunk_indexes_, attachment_indexes_, metadata_indexes_;
    std::map<std::uint16_t, std::uint64_t> counts_;
    std::uint64_t first_ = 0;
    std::uint64_t last_ = 0;
    std::uint32_t chunks_ = 0;
    std::uint32_t attachments_ = 0;
    std::uint32_t metadata_ = 0;
};

}  // namespace disparityd::test
