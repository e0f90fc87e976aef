// SPDX-License-Identifier: Apache-2.0
#include "formats/unpack.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include "base/message_text.h"
#include "formats/mcap_chunk.h"

namespace disparityd::formats {
namespace {

[[noreturn]] void fail_size(std::string_view packing, std::size_t expected) {
    throw std::runtime_error("a chunk cannot be unpacked: its " + std::string(packing) + " data are no " +
                             std::to_string(expected) + " bytes");
}

struct FreeLz4 {
    void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

/// A shell takes the text as one word, whatever a stranger wrote into it.
std::string quoted(const std::string& path) {
    std::string text = "'";
    for (const char c : base::printable(path, path.size())) {
        text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return text + "'";
}

}  // namespace

void unpack_zstd(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room) {
    const std::size_t size = ZSTD_decompress(room.data(), room.size(), packed.data(), packed.size());
    if (ZSTD_isError(size) != 0) {
        throw std::runtime_error(std::string("a chunk cannot be unpacked: zstd: ") + ZSTD_getErrorName(size));
    }
    if (size != room.size()) {
        fail_size("zstd", room.size());
    }
}

void unpack_zstd_message(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room) {
    const unsigned long long size = ZSTD_getFrameContentSize(packed.data(), packed.size());
    if (size > mcap_most_bytes) {  // so are the numbers of frames that state none
        throw std::runtime_error("a message packed by zstd does not state a size of up to " +
                                 std::to_string(mcap_most_bytes) + " bytes");
    }
    room.clear();
    room.resize(static_cast<std::size_t>(size));
    unpack_zstd(packed, room);
}

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

void unpack_bz2(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& room) {
    auto size = static_cast<unsigned>(std::min<std::size_t>(room.size(), std::numeric_limits<unsigned>::max()));
    // The library's interface is older than const.
    auto* from = reinterpret_cast<char*>(const_cast<std::uint8_t*>(packed.data()));
    char none = 0;
    char* into = room.empty() ? &none : reinterpret_cast<char*>(room.data());
    const int result = BZ2_bzBuffToBuffDecompress(into, &size, from, static_cast<unsigned>(packed.size()), 0, 0);
    if (result == BZ_MEM_ERROR) {
        throw std::bad_alloc();
    }
    if (result != BZ_OK || size != room.size()) {
        fail_size("bz2", room.size());
    }
}

std::string zstd_command(const std::string& path) {
    // The program knows one ending, .zst, and needs a name for the others.
    const std::size_t name = path.rfind('/') + 1;  // 0 where there is none
    const std::size_t at = path.rfind(".zst");
    const bool ending = at != std::string::npos && at > name;
    return "zstd -d " + quoted(path) + " -o " + quoted(ending ? path.substr(0, at) : path + ".unpacked");
}

}  // namespace disparityd::formats
