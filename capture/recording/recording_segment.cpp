// SPDX-License-Identifier: Apache-2.0
#include "capture/recording/recording_segment.h"

#include <algorithm>
#include <array>
#include <bit>

namespace disparityd::capture {
namespace {

constexpr std::uint64_t id_ebml = 0x1A45DFA3;
constexpr std::uint64_t id_segment = 0x18538067;
constexpr std::uint64_t id_cluster = 0x1F43B675;
constexpr std::uint64_t id_block_group = 0xA0;
constexpr std::uint64_t id_simple_block = 0xA3;

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

struct Element {
    std::uint64_t id = 0;
    std::uint64_t size_at = 0;
    int size_length = 0;
    std::uint64_t data = 0;  ///< where its data begin
    std::uint64_t end = 0;
};

/// Reads the head of the element at `at`; nothing where none can be.
std::optional<Element> element_at(const ReadBytes& read, std::uint64_t at) {
    std::array<std::uint8_t, 16> head{};
    const std::size_t got = read(at, head);
    EbmlReader reader(std::span<const std::uint8_t>(head.data(), got));
    Element element;
    const auto id = reader.id();
    element.size_at = at + reader.position();
    element.size_length = reader.next_length();
    const auto size = reader.size();
    if (!id || !size || *size > std::uint64_t{1} << 60U) {
        return std::nullopt;
    }
    element.id = *id;
    element.data = at + reader.position();
    element.end = element.data + *size;
    return element;
}

/// Takes the whole blocks of a cluster.
void take_blocks(const ReadBytes& read, const Element& cluster, std::uint64_t size, MatroskaPart& part) {
    std::uint64_t end = 0;
    for (std::uint64_t at = cluster.data; at < cluster.end;) {
        const auto element = element_at(read, at);
        if (!element || element->end > std::min(cluster.end, size)) {
            break;
        }
        at = element->end;
        if (element->id == id_block_group || element->id == id_simple_block) {
            ++part.frames;
            end = at;
        }
    }
    if (end == 0) {
        return;
    }
    part.end = cluster.end <= size ? cluster.end : end;
    if (cluster.end > size) {
        part.cluster = {cluster.size_at, cluster.size_length, end - cluster.data};
    }
}

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

MatroskaPart find_whole_part(const ReadBytes& read, std::uint64_t begin, std::uint64_t size) {
    MatroskaPart part;
    part.end = begin;
    for (std::uint64_t at = begin; at < size;) {
        const auto element = element_at(read, at);
        if (!element) {
            break;
        }
        if (element->id == id_cluster) {
            take_blocks(read, *element, size, part);
        } else if (part.frames == 0 && element->end <= size) {
            part.end = element->end;  // what stands before the first frame
        }
        at = element->end;
    }
    return part;
}

void put_ebml_size(std::uint64_t size, std::span<std::uint8_t> field) {
    for (std::size_t i = field.size(); i-- > 0; size >>= 8U) {
        field[i] = static_cast<std::uint8_t>(size);
    }
    field[0] = static_cast<std::uint8_t>(field[0] | 0x80U >> (field.size() - 1));
}

}  // namespace disparityd::capture
