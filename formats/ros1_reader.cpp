// SPDX-License-Identifier: Apache-2.0
#include "formats/ros1_reader.h"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>

namespace disparityd::formats {

std::span<const std::uint8_t> Ros1Reader::elements(std::size_t count, std::size_t size) {
    if (count > left() / size) {
        throw std::runtime_error("ends too soon: " + std::to_string(count) + " x " + std::to_string(size) +
                                 " bytes are expected at byte " + std::to_string(place_) + ", " +
                                 std::to_string(left()) + " are there");
    }
    place_ += count * size;
    return message_.subspan(place_ - count * size, count * size);
}

std::string_view Ros1Reader::text() {
    const auto bytes = elements(get<std::uint32_t>(), 1);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void Ros1Reader::take_number(std::span<std::uint8_t> into) {
    const auto bytes = elements(1, into.size());
    std::copy(bytes.begin(), bytes.end(), into.begin());
    if (std::endian::native == std::endian::big) {
        std::reverse(into.begin(), into.end());
    }
}

}  // namespace disparityd::formats
