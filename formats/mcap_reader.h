// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/bag_file.h"
#include "formats/mcap_fields.h"

namespace disparityd::formats {

/// Reads the messages of an MCAP file (https://mcap.dev/spec) in the order in which they lie there, from the first to
/// the last. It holds one chunk at a time, at most 256 MiB. One thread uses an object at a time.
///
/// The constructor and next() throw std::runtime_error with one line that begins with the path: where the file is
/// damaged, has records or chunks of more than 256 MiB, or was cut off. All that is whole before was then returned.
class McapReader {
public:
    /// Opens the file and reads its summary, where it has one: what is in it is known then. A summary that is damaged
    /// counts as none. Throws std::invalid_argument for a file that is not MCAP.
    explicit McapReader(const std::string& path);

    /// Whether definitions() and message_count() know the whole file before it is read.
    bool has_summary() const { return has_summary_; }

    /// Returns the schemas and channels that are known so far.
    const McapDefinitions& definitions() const { return definitions_; }

    /// Returns how many messages a channel has by the statistics of the summary; nothing where they are missing.
    std::optional<std::uint64_t> message_count(std::uint16_t channel) const;

    /// Reads the next message, whose data are valid until the next call. Returns false after the last one.
    bool next(McapMessage& message);

    /// Returns how many bytes of the file were read.
    std::uint64_t position() const { return file_.position(); }

private:
    struct RecordHead {
        McapOpcode opcode;
        std::uint64_t length;
    };

    void read_summary();
    void take_summary(std::span<const std::uint8_t> records);
    void take_statistics(std::span<const std::uint8_t> content);
    bool next_of_chunk(McapMessage& message);
    McapMessage known_message(std::span<const std::uint8_t> content) const;
    std::optional<RecordHead> next_head();
    bool read_record(const RecordHead& head, McapMessage& message);
    void read_bytes(std::span<std::uint8_t> into);
    std::span<const std::uint8_t> read_content(std::uint64_t length);
    void skip_content(std::uint64_t length);
    void skip_attachment(std::uint64_t length);
    void check_data_end(std::span<const std::uint8_t> content, std::uint32_t checksum) const;

    BagFile file_;
    std::uint32_t checksum_ = 0;  ///< of all bytes up to position()
    bool has_summary_ = false;
    bool ended_ = false;
    McapDefinitions definitions_;
    std::optional<std::map<std::uint16_t, std::uint64_t>> counts_;
    std::vector<std::uint8_t> record_;     ///< the content of a record
    std::vector<std::uint8_t> unpacked_;   ///< the records of a packed chunk
    std::span<const std::uint8_t> chunk_;  ///< what of the chunk was not read yet
};

}  // namespace disparityd::formats
