// SPDX-License-Identifier: Apache-2.0
#include "tests/bridges/decoded_frame.h"

#include <array>
#include <bit>

#include "bridges/mavlink/attitude.h"
#include "bridges/mavlink/heartbeat.h"

namespace disparityd::test {
namespace {

constexpr std::size_t header = 10;
constexpr std::array kinds{mavlink::heartbeat_kind, mavlink::obstacle_distance_kind, mavlink::obstacle_distance_3d_kind,
                           mavlink::command_long_kind};

}  // namespace

std::uint64_t DecodedFrame::number(std::size_t offset, std::size_t bytes) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
        value |= std::uint64_t{payload.at(offset + i)} << (8 * i);
    }
    return value;
}

float DecodedFrame::real(std::size_t offset) const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(number(offset, 4)));
}

mavlink::SectorDistances DecodedFrame::distances() const {
    mavlink::SectorDistances distances{};
    for (std::size_t i = 0; i < distances.size(); ++i) {
        distances[i] = static_cast<std::uint16_t>(number(8 + 2 * i, 2));
    }
    return distances;
}

std::optional<DecodedFrame> decode(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < header + 3 || bytes[0] != 0xfd || bytes.size() != header + bytes[1] + 2U) {
        return std::nullopt;
    }
    const std::uint32_t id = bytes[7] | std::uint32_t{bytes[8]} << 8 | std::uint32_t{bytes[9]} << 16;
    DecodedFrame frame{bytes[4], bytes[5], bytes[6], id, {}};
    for (const mavlink::MessageKind& kind : kinds) {
        if (kind.id != frame.id || bytes[1] > kind.length) {
            continue;
        }
        const auto sum =
            mavlink::crc(std::span(&kind.crc_extra, 1), mavlink::crc(bytes.subspan(1, header - 1 + bytes[1])));
        if (bytes[bytes.size() - 2] != (sum & 0xff) || bytes.back() != sum >> 8) {
            return std::nullopt;
        }
        frame.payload.assign(bytes.begin() + header, bytes.end() - 2);
        frame.payload.resize(kind.length);
        return frame;
    }
    return std::nullopt;
}

std::vector<DecodedFrame> take_frames(std::vector<std::uint8_t>& stream) {
    std::vector<DecodedFrame> frames;
    while (stream.size() > 1 && stream.size() >= header + stream[1] + 2U) {
        const std::size_t size = header + stream[1] + 2U;
        const auto frame = decode(std::span(stream).first(size));
        if (!frame) {
            break;
        }
        frames.push_back(*frame);
        stream.erase(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
    }
    return frames;
}

}  // namespace disparityd::test
