// SPDX-License-Identifier: Apache-2.0
#include "proto/framing.h"

#include <stdexcept>
#include <string>

namespace disparityd::proto {

void encode(const v1::Envelope& envelope, std::vector<std::uint8_t>& out) {
    const std::size_t size = envelope.ByteSizeLong();
    if (size > max_envelope_bytes) {
        throw std::invalid_argument("message of " + std::to_string(size) + " bytes, allowed " +
                                    std::to_string(max_envelope_bytes));
    }
    out.resize(length_bytes + size);
    for (std::size_t i = 0; i < length_bytes; ++i) {
        out[i] = static_cast<std::uint8_t>((size >> (8 * i)) & 0xff);
    }
    envelope.SerializeWithCachedSizesToArray(out.data() + length_bytes);
}

std::uint32_t decode_length(std::span<const std::uint8_t, length_bytes> bytes, std::uint32_t limit) {
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < length_bytes; ++i) {
        length |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
    }
    if (length > limit) {
        throw std::invalid_argument("message of " + std::to_string(length) + " bytes announced, allowed " +
                                    std::to_string(limit) + ": not the disparityd protocol, or another version of it");
    }
    return length;
}

void decode(std::span<const std::uint8_t> bytes, v1::Envelope& envelope) {
    if (bytes.size() > max_envelope_bytes || !envelope.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
        throw std::invalid_argument("a message of " + std::to_string(bytes.size()) +
                                    " bytes is no disparityd.v1.Envelope");
    }
}

std::uint64_t raw_plane_bytes(const v1::PlaneInfo& plane) {
    const auto check = [](const char* what, std::uint32_t found, std::uint32_t allowed) {
        if (found == 0 || found > allowed) {
            throw std::invalid_argument(std::string("plane with ") + what + " " + std::to_string(found) +
                                        ", allowed 1.." + std::to_string(allowed));
        }
    };
    check("width", plane.width(), max_image_side);
    check("height", plane.height(), max_image_side);
    check("bytes_per_pixel", plane.bytes_per_pixel(), 8);
    return std::uint64_t{plane.width()} * plane.height() * plane.bytes_per_pixel();
}

}  // namespace disparityd::proto
