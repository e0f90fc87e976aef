// SPDX-License-Identifier: Apache-2.0
#include "tests/vm/camera/test_pattern.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace simulated_camera {

namespace {

using Group = std::array<std::uint8_t, 4>;

Group little_endian(std::uint32_t value) {
    return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8),
            static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 24)};
}

Group group_at(std::uint32_t number, std::size_t index) {
    if (index == 0) {
        return little_endian(number);
    }
    const std::uint32_t mixed = (static_cast<std::uint32_t>(index) + number * 0x9E3779B1U) * 0x85EBCA6BU;
    return little_endian(mixed ^ (mixed >> 15));
}

}  // namespace

void fill_pattern(std::uint32_t number, std::span<std::uint8_t> frame) {
    for (std::size_t at = 0; at < frame.size(); at += 4) {
        const Group group = group_at(number, at / 4);
        std::memcpy(frame.data() + at, group.data(), std::min<std::size_t>(4, frame.size() - at));
    }
}

std::uint8_t pattern_byte(std::uint32_t number, std::size_t index) {
    return group_at(number, index / 4)[index % 4];
}

std::uint32_t pattern_number(std::span<const std::uint8_t> frame) {
    std::uint32_t number = 0;
    for (std::size_t i = std::min<std::size_t>(4, frame.size()); i > 0; --i) {
        number = number << 8 | frame[i - 1];
    }
    return number;
}

std::ptrdiff_t first_difference_from_pattern(std::span<const std::uint8_t> frame) {
    const std::uint32_t number = pattern_number(frame);
    for (std::size_t at = 0; at < frame.size(); at += 4) {
        const Group group = group_at(number, at / 4);
        const std::size_t length = std::min<std::size_t>(4, frame.size() - at);
        if (std::memcmp(frame.data() + at, group.data(), length) != 0) {
            std::size_t i = 0;
            while (frame[at + i] == group[i]) {
                ++i;
            }
            return static_cast<std::ptrdiff_t>(at + i);
        }
    }
    return -1;
}

}  // namespace simulated_camera
