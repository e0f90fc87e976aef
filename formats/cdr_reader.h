// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "formats/message_bytes.h"

namespace disparityd::formats {

/// Reads one message of CDR as ROS 2 writes it: XCDR version 1, either byte order. It borrows the bytes, and so do the
/// texts and bytes that it returns. It allocates nothing beyond what the message holds. Every function throws
/// std::runtime_error with one line where the message ends too soon; the line does not say which message it is.
class CdrReader {
public:
    /// Reads the header of 4 bytes. Throws for another version of CDR.
    explicit CdrReader(std::span<const std::uint8_t> message);

    /// Reads a number, which lies at a multiple of its size.
    template <typename Number>
    Number get() {
        align(sizeof(Number));
        return number_at<Number>(bytes_.take(1, sizeof(Number)).data());
    }

    /// Reads so many numbers.
    template <typename Number>
    std::vector<Number> get(std::size_t count) {
        const auto raw = elements(count, sizeof(Number));
        std::vector<Number> numbers(count);
        for (std::size_t i = 0; i < count; ++i) {
            numbers[i] = number_at<Number>(raw.data() + i * sizeof(Number));
        }
        return numbers;
    }

    /// Reads a length and so many numbers.
    template <typename Number>
    std::vector<Number> sequence() {
        return get<Number>(get<std::uint32_t>());
    }

    /// Returns the bytes of so many numbers of one size as they lie in the message.
    std::span<const std::uint8_t> elements(std::size_t count, std::size_t size);

    /// Reads a string without the 0 at its end. Some writers leave an empty one without it.
    std::string_view text();

    /// Returns how many bytes were not read yet.
    std::size_t left() const { return bytes_.left(); }

private:
    static constexpr std::size_t header_size = 4;

    void align(std::size_t size);

    template <typename Number>
    Number number_at(const std::uint8_t* from) const {
        static_assert(std::is_arithmetic_v<Number>);
        std::uint8_t bytes[sizeof(Number)];
        for (std::size_t i = 0; i < sizeof(Number); ++i) {
            bytes[i] = from[swapped_ ? sizeof(Number) - 1 - i : i];
        }
        Number number{};
        std::memcpy(&number, bytes, sizeof number);
        return number;
    }

    MessageBytes bytes_;
    bool swapped_ = false;  ///< the message has the other byte order than this processor
};

}  // namespace disparityd::formats
