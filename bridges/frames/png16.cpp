// SPDX-License-Identifier: Apache-2.0
#include "bridges/frames/png16.h"

#include <cstddef>
#include <new>
#include <string_view>
#include <vector>

#include <zlib.h>

namespace disparityd::frames {
namespace {

using Octets = std::vector<std::uint8_t>;

/// Owns the library's state.
class Deflater {
public:
    Deflater() {
        constexpr int level = 1;
        constexpr int window_bits = 15;
        constexpr int memory_level = 8;
        if (deflateInit2(&stream_, level, Z_DEFLATED, window_bits, memory_level, Z_DEFAULT_STRATEGY) != Z_OK) {
            throw std::bad_alloc();
        }
    }
    ~Deflater() { deflateEnd(&stream_); }
    Deflater(const Deflater&) = delete;
    Deflater& operator=(const Deflater&) = delete;

    /// Appends the compressed bytes.
    void append(std::string& to, const Octets& bytes) {
        deflateReset(&stream_);
        const std::size_t before = to.size();
        to.resize(before + deflateBound(&stream_, bytes.size()));
        stream_.next_in = const_cast<Bytef*>(bytes.data());
        stream_.avail_in = static_cast<uInt>(bytes.size());
        stream_.next_out = reinterpret_cast<Bytef*>(to.data() + before);
        stream_.avail_out = static_cast<uInt>(to.size() - before);
        deflate(&stream_, Z_FINISH);  // it cannot fail: the room is large enough
        to.resize(to.size() - stream_.avail_out);
    }

private:
    z_stream stream_{};
};

/// Returns the rows as a PNG has them before it is compressed: high bytes first, and the number of a filter before each
/// row. Depths follow from few disparities, so that the same ones come again: without a filter most pictures are
/// smaller, and made sooner, than with any.
Octets unfiltered(std::span<const std::uint8_t> pixels, std::uint32_t width, std::uint32_t height) {
    constexpr std::uint8_t no_filter = 0;
    const std::size_t row_bytes = std::size_t{2} * width;
    Octets rows((row_bytes + 1) * height);
    const std::uint8_t* from = pixels.data();
    std::uint8_t* to = rows.data();
    for (std::uint32_t y = 0; y < height; ++y) {
        *to++ = no_filter;
        for (std::size_t i = 0; i < row_bytes; i += 2) {
            to[i] = from[i + 1];
            to[i + 1] = from[i];
        }
        to += row_bytes;
        from += row_bytes;
    }
    return rows;
}

void append_u32(std::string& png, std::size_t value) {
    for (const int shift : {24, 16, 8, 0}) {
        png.push_back(static_cast<char>(value >> shift & 255));
    }
}

/// Appends a chunk whose content `write` appends.
template <typename Write>
void append_chunk(std::string& png, std::string_view type, Write write) {
    const std::size_t start = png.size();
    append_u32(png, 0);
    png += type;
    write();
    const std::size_t length = png.size() - start - 8;
    std::string head;
    append_u32(head, length);
    png.replace(start, head.size(), head);
    const auto* const checked = reinterpret_cast<const Bytef*>(png.data() + start + 4);
    append_u32(png, crc32(0, checked, static_cast<uInt>(length + 4)));
}

}  // namespace

std::string png16_of(std::span<const std::uint8_t> pixels, std::uint32_t width, std::uint32_t height) {
    thread_local Deflater deflater;
    const Octets rows = unfiltered(pixels, width, height);
    std::string png("\x89PNG\r\n\x1a\n");
    append_chunk(png, "IHDR", [&] {
        append_u32(png, width);
        append_u32(png, height);
        png += {16, 0, 0, 0, 0};  // bits, grey, deflate, five filters, not interlaced
    });
    append_chunk(png, "IDAT", [&] { deflater.append(png, rows); });
    append_chunk(png, "IEND", [] {});
    return png;
}

}  // namespace disparityd::frames
