// SPDX-License-Identifier: Apache-2.0
#include "formats/message_bytes.h"

#include <stdexcept>
#include <string>

namespace disparityd::formats {

std::span<const std::uint8_t> MessageBytes::take(std::size_t count, std::size_t size) {
    if (count > left() / size) {
        throw std::runtime_error("ends too soon: " + std::to_string(count) + " x " + std::to_string(size) +
                                 " bytes are expected at byte " + std::to_string(place_) + ", " +
                                 std::to_string(left()) + " are there");
    }
    place_ += count * size;
    return message_.subspan(place_ - count * size, count * size);
}

}  // namespace disparityd::formats
