// SPDX-License-Identifier: Apache-2.0
#include "bridges/frames/rvl.h"

#include <cstddef>
#include <cstring>

namespace disparityd::frames {
namespace {

/// Writes numbers of few bits where they are small: three bits in each nibble, the lowest first; the fourth bit says
/// that more follow.
class Nibbles {
public:
    explicit Nibbles(std::size_t expected_bytes) { bytes_.reserve(expected_bytes); }

    void number(std::uint32_t value) {
        while (value > 7) {
            nibble(8 | (value & 7));
            value >>= 3;
        }
        nibble(value);
    }

    std::string take() {
        while (filled_ > 0) {
            nibble(0);
        }
        return std::move(bytes_);
    }

private:
    void nibble(std::uint32_t value) {
        word_ = word_ << 4 | value;
        if (++filled_ == 8) {
            char bytes[sizeof word_];
            std::memcpy(bytes, &word_, sizeof word_);  // every machine that this is built for is little endian
            bytes_.append(bytes, sizeof bytes);
            filled_ = 0;
        }
    }

    std::string bytes_;
    std::uint32_t word_ = 0;
    int filled_ = 0;  ///< nibbles of the word
};

/// 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ...
std::uint32_t without_sign(std::int32_t value) {
    return value < 0 ? 2 * static_cast<std::uint32_t>(-(value + 1)) + 1 : 2 * static_cast<std::uint32_t>(value);
}

}  // namespace

std::string rvl_of(std::span<const std::uint8_t> depths) {
    const std::size_t count = depths.size() / 2;
    const auto depth = [bytes = depths.data()](std::size_t i) {
        std::uint16_t value;
        std::memcpy(&value, bytes + 2 * i, sizeof value);
        return value;
    };
    const auto end_of_run = [&](std::size_t i, bool zeros) {
        while (i < count && (depth(i) == 0) == zeros) {
            ++i;
        }
        return i;
    };
    Nibbles nibbles(depths.size() / 2);  // mostly it is less
    std::int32_t before = 0;
    for (std::size_t i = 0; i < count;) {
        const std::size_t first = end_of_run(i, true);
        const std::size_t last = end_of_run(first, false);
        nibbles.number(static_cast<std::uint32_t>(first - i));
        nibbles.number(static_cast<std::uint32_t>(last - first));
        for (i = first; i < last; ++i) {
            const std::int32_t now = depth(i);
            nibbles.number(without_sign(now - before));
            before = now;
        }
    }
    return nibbles.take();
}

}  // namespace disparityd::frames
