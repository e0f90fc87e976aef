// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/frame_reader.h"

#include <algorithm>

namespace disparityd::mavlink {
namespace {

constexpr std::size_t header = 10;
constexpr std::size_t checksum = 2;
constexpr std::size_t signature = 13;
constexpr std::uint8_t is_signed = 1;  // of the flags that a receiver must understand

}  // namespace

void FrameReader::take(std::span<const std::uint8_t> bytes,
                       const std::function<void(const ReceivedFrame& frame)>& found) {
    begun_.insert(begun_.end(), bytes.begin(), bytes.end());
    std::size_t done = 0;
    while (true) {
        const auto start = std::find(begun_.begin() + static_cast<std::ptrdiff_t>(done), begun_.end(), frame_magic);
        done = static_cast<std::size_t>(start - begun_.begin());
        const std::size_t taken = take_one(std::span(begun_).subspan(done), found);
        if (taken == 0) {
            break;
        }
        done += taken;
    }
    begun_.erase(begun_.begin(), begun_.begin() + static_cast<std::ptrdiff_t>(done));
}

/// Returns how many bytes are done with: a frame, or one that begins none; 0: the rest must come first. Of other kinds
/// the checksum cannot be known.
std::size_t FrameReader::take_one(std::span<const std::uint8_t> bytes,
                                  const std::function<void(const ReceivedFrame& frame)>& found) const {
    if (bytes.size() < header) {
        return 0;
    }
    const std::size_t length = bytes[1];
    const std::uint8_t flags = bytes[2];
    if ((flags & ~is_signed) != 0) {
        return 1;
    }
    const std::size_t all = header + length + checksum + (flags == is_signed ? signature : 0);
    if (bytes.size() < all) {
        return 0;
    }
    const std::uint32_t id = bytes[7] | std::uint32_t{bytes[8]} << 8 | std::uint32_t{bytes[9]} << 16;
    if (id != kind_.id) {
        return all;
    }
    const std::uint16_t sum = crc(std::span(&kind_.crc_extra, 1), crc(bytes.subspan(1, header - 1 + length)));
    if ((bytes[header + length] | bytes[header + length + 1] << 8) != sum) {
        return 1;
    }
    ReceivedFrame frame{bytes[5], bytes[6], {}};
    const auto payload = bytes.subspan(header, std::min(length, kind_.length));
    frame.payload.assign(payload.begin(), payload.end());
    frame.payload.resize(kind_.length);
    found(frame);
    return all;
}

}  // namespace disparityd::mavlink
