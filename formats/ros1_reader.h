// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

#include "formats/message_bytes.h"

namespace disparityd::formats {

/// Reads one message as ROS 1 writes it: little endian, fields without gaps. It borrows the bytes, and so do the texts
/// and bytes that it returns. Every function throws std::runtime_error with one line where the message ends too soon.
class Ros1Reader {
public:
    explicit Ros1Reader(std::span<const std::uint8_t> message) : bytes_(message) {}

    template <typename Number>
    Number get() {
        Number number{};
        std::uint8_t bytes[sizeof(Number)];
        take_number(bytes);
        std::memcpy(&number, bytes, sizeof number);
        return number;
    }

    /// Returns the bytes of so many numbers of one size.
    std::span<const std::uint8_t> elements(std::size_t count, std::size_t size) { return bytes_.take(count, size); }

    std::string_view text();

    /// Returns how many bytes were not read yet.
    std::size_t left() const { return bytes_.left(); }

private:
    /// Puts the bytes of a number in this processor's order.
    void take_number(std::span<std::uint8_t> into);

    MessageBytes bytes_;
};

}  // namespace disparityd::formats
