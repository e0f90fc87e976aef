// SPDX-License-Identifier: Apache-2.0
#include "formats/mcap_chunk.h"

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include "base/message_text.h"
#include "formats/mcap_fields.h"

namespace disparityd::formats {
namespace {

[[noreturn]] void fail_size(std::string_view packing, std::size_t expected) {
    throw std::runtime_error("a chunk cannot be unpacked: its " + std::string(packing) + " data are no " +
                             std::to_string(expected) + " bytes");
}

void unpack_zstd(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room) {
    const std::size_t size = ZSTD_decompress(room.data(), room.size(), packed.data(), packed.size());
    if (ZSTD_isError(size) != 0) {
        throw std::runtime_error(std::string("a chunk cannot be unpacked: zstd: ") + ZSTD_getErrorName(size));
    }
    if (size != room.size()) {
        fail_size("zstd", room.size());
    }
}

struct FreeLz4 {
    void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

void unpack_lz4(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room) {
    LZ4F_dctx* raw = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) {
        throw std::bad_alloc();
    }
    const std::unique_ptr<LZ4F_dctx, FreeLz4> context(raw);
    std::size_t done = 0;
    for (bool ended = room.empty() && packed.empty(); !ended;) {
        std::size_t taken = packed.size();
        std::size_t made = room.size() - done;
        const std::size_t next =
            LZ4F_decompress(context.get(), room.data() + done, &made, packed.data(), &taken, nullptr);
        if (LZ4F_isError(next) != 0) {
            throw std::runtime_error(std::string("a chunk cannot be unpacked: lz4: ") + LZ4F_getErrorName(next));
        }
        done += made;
        packed = packed.subspan(taken);
        ended = next == 0 && packed.empty();
        if (!ended && made == 0 && taken == 0) {
            fail_size("lz4", room.size());
        }
    }
    if (done != room.size()) {
        fail_size("lz4", room.size());
    }
}

}  // namespace

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
