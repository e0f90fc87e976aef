// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_segment.h"

#include <bit>

namespace disparityd::capture {
namespace {

constexpr std::uint64_t id_ebml = 0x1A45DFA3;
constexpr std::uint64_t id_segment = 0x18538067;

/// Reads EBML's numbers of variable length (RFC 8794): leading zero bits of the first byte give the length.
class EbmlReader {
public:
    explicit EbmlReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::size_t position() const { return position_; }
    void skip(std::uint64_t count) { position_ = count < bytes_.size() ? position_ + count : bytes_.size(); }

    /// An element's name, marker bit included.
    std::optional<std::uint64_t> id() { return number(0xFF); }

    /// An element's size, marker bit removed.
    std::optional<std::uint64_t> size() {
        const int length = next_length();
        return number(length == 0 ? 0 : 0xFFU >> length);
    }

    int next_length() const { return position_ < bytes_.size() ? std::countl_zero(bytes_[position_]) + 1 : 0; }

private:
    std::optional<std::uint64_t> number(unsigned first_mask) {
        const int length = next_length();
        if (length < 1 || length > 8 || position_ + static_cast<std::size_t>(length) > bytes_.size()) {
            return std::nullopt;
        }
        std::uint64_t value = bytes_[position_] & first_mask;
        for (int i = 1; i < length; ++i) {
            value = value << 8U | bytes_[position_ + static_cast<std::size_t>(i)];
        }
        position_ += static_cast<std::size_t>(length);
        return value;
    }

    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
};

}  // namespace

std::optional<MatroskaSegment> find_segment(std::span<const std::uint8_t> head) {
    EbmlReader reader(head);
    if (reader.id() != id_ebml) {
        return std::nullopt;
    }
    const auto header_size = reader.size();
    if (!header_size) {
        return std::nullopt;
    }
    reader.skip(*header_size);
    if (reader.id() != id_segment) {
        return std::nullopt;
    }
    MatroskaSegment segment;
    segment.size_offset = reader.position();
    segment.size_length = reader.next_length();
    const auto size = reader.size();
    if (!size) {
        return std::nullopt;
    }
    segment.data_offset = reader.position();
    const std::uint64_t unknown = (std::uint64_t{1} << (7 * segment.size_length)) - 1;
    if (*size != unknown) {
        segment.size = *size;
    }
    return segment;
}

}  // namespace disparityd::capture
