// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

namespace disparityd::test {

/// Returns a string of these bytes.
std::string bytes(std::initializer_list<int> values);

/// Reads CDR of version 1, little endian. Throws std::runtime_error for another header and beyond the end.
class CdrReader {
public:
    explicit CdrReader(std::string bytes);

    /// Reads a number, which lies at a multiple of its size.
    template <typename Number>
    Number get() {
        place_ += (sizeof(Number) - (place_ - start) % sizeof(Number)) % sizeof(Number);
        Number number{};
        std::memcpy(&number, take(sizeof number), sizeof number);
        return number;
    }

    /// Reads so many numbers.
    template <typename Number>
    std::vector<Number> get(std::size_t count) {
        std::vector<Number> numbers;
        for (std::size_t i = 0; i < count; ++i) {
            numbers.push_back(get<Number>());
        }
        return numbers;
    }

    /// Reads a length and so many numbers.
    template <typename Number>
    std::vector<Number> sequence() {
        return get<Number>(get<std::uint32_t>());
    }

    std::string text();

    /// Reads a std_msgs/msg/Header and returns "SECONDS.NANOSECONDS FRAME".
    std::string header();

    std::size_t left() const { return bytes_.size() - place_; }  ///< bytes that were not read yet

private:
    static constexpr std::size_t start = 4;

    const char* take(std::size_t size);

    std::string bytes_;
    std::size_t place_ = start;
};

}  // namespace disparityd::test
