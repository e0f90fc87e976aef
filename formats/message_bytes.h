// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace disparityd::formats {

/// The bytes of one message, which are taken from its begin to its end. It borrows them.
class MessageBytes {
public:
    /// The first `place` bytes count as taken; there are as many.
    explicit MessageBytes(std::span<const std::uint8_t> message, std::size_t place = 0)
        : message_(message), place_(place) {}

    /// Takes so many parts of `size` bytes. Throws std::runtime_error with one line where the message ends too soon.
    std::span<const std::uint8_t> take(std::size_t count, std::size_t size);

    /// Returns how many bytes were taken.
    std::size_t place() const { return place_; }

    /// Returns how many bytes follow.
    std::size_t left() const { return message_.size() - place_; }

private:
    std::span<const std::uint8_t> message_;
    std::size_t place_;
};

}  // namespace disparityd::formats
