// SPDX-License-Identifier: Apache-2.0
#include "formats/cdr_reader.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace disparityd::formats {

CdrReader::CdrReader(std::span<const std::uint8_t> message) : bytes_(message, std::min(message.size(), header_size)) {
    if (message.size() < header_size) {
        throw std::runtime_error("found " + std::to_string(message.size()) +
                                 " bytes, expected CDR with a header of 4 bytes");
    }
    const bool little = message[1] == 1;
    if (message[0] != 0 || message[1] > 1) {
        throw std::runtime_error("found CDR of the kind " + std::to_string(message[0] << 8 | message[1]) +
                                 ", allowed are 0 and 1 (plain CDR of version 1, as ROS 2 writes it)");
    }
    swapped_ = little != (std::endian::native == std::endian::little);
}

void CdrReader::align(std::size_t size) {
    const std::size_t over = (bytes_.place() - header_size) % size;
    if (over != 0) {
        bytes_.take(size - over, 1);
    }
}

std::span<const std::uint8_t> CdrReader::elements(std::size_t count, std::size_t size) {
    if (count > 0) {  // an empty sequence has no element that would have to be aligned
        align(size);
    }
    return bytes_.take(count, size);
}

std::string_view CdrReader::text() {
    const auto size = get<std::uint32_t>();
    const auto bytes = bytes_.take(size, 1);
    if (size == 0) {
        return {};
    }
    if (bytes.back() != 0) {
        throw std::runtime_error("a string that ends at byte " + std::to_string(bytes_.place()) +
                                 " does not end with 0");
    }
    return {reinterpret_cast<const char*>(bytes.data()), size - 1};
}

}  // namespace disparityd::formats
