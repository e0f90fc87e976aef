// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_chunk.h"

#include <stdexcept>
#include <string>
#include <string_view>

#include <zlib.h>

#include "base/message_text.h"
#include "formats/mcap_fields.h"
#include "formats/unpack.h"

namespace disparityd::formats {

std::span<const std::uint8_t> mcap_chunk_records(std::span<const std::uint8_t> content,
                                                 std::vector<std::uint8_t>& room) {
    McapFields fields(content);
    fields.u64();  // the times of its first and last message, which the messages have, too
    fields.u64();
    const std::uint64_t size = fields.u64();
    const std::uint32_t checksum = fields.u32();
    const std::string_view packing = fields.text();
    const auto packed = fields.bytes(fields.u64());
    if (size > mcap_most_bytes) {
        throw std::runtime_error("a chunk has " + std::to_string(size) + " bytes, allowed are up to " +
                                 std::to_string(mcap_most_bytes));
    }
    std::span<const std::uint8_t> records = packed;
    if (packing.empty()) {
        if (packed.size() != size) {
            throw std::runtime_error("a chunk of " + std::to_string(packed.size()) + " bytes says that it has " +
                                     std::to_string(size));
        }
    } else {
        room.clear();  // so that it never has more than it needs
        room.resize(static_cast<std::size_t>(size));
        if (packing == "zstd") {
            unpack_zstd(packed, room);
        } else if (packing == "lz4") {
            unpack_lz4(packed, room);
        } else {
            throw std::runtime_error("a chunk is packed by '" + base::printable(packing) +
                                     "', allowed are zstd, lz4 and nothing");
        }
        records = room;
    }
    // 0: the writer did not compute one.
    if (checksum != 0 && checksum != ::crc32_z(0, records.data(), records.size())) {
        throw std::runtime_error("the checksum of a chunk is wrong");
    }
    return records;
}

}  // namespace disparityd::formats
