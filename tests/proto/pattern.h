// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "proto/frame_info.h"
#include "proto/shared_memory_writer.h"

/// Frames of which every byte follows from the sequence number, so that a mixture of two of them is always found.
namespace pattern {

/// Odd sizes: rows that are no multiple of 8 bytes.
inline disparityd::proto::ShmLayout layout(std::uint32_t width = 321, std::uint32_t height = 123) {
    return {width, height, {{1, 2}, {2, 1}, {5, 3}}};
}

inline std::uint64_t word(std::uint64_t sequence, std::uint64_t product, std::uint64_t index) {
    return (sequence * 0x9e3779b97f4a7c15ULL) ^ (index * 0xff51afd7ed558ccdULL + product);
}

/// The planes of a frame with rows further apart than they are long.
class Source {
public:
    explicit Source(const disparityd::proto::ShmLayout& layout) : layout_(layout), buffers_(layout.planes.size()) {}

    const std::vector<disparityd::proto::PlaneSource>& make(std::uint64_t sequence) {
        planes_.clear();
        for (std::size_t p = 0; p < layout_.planes.size(); ++p) {
            const std::size_t row = std::size_t{layout_.width} * layout_.planes[p].bytes_per_pixel;
            const std::size_t stride = row + 40;
            dense_.resize(row * layout_.height + 8);
            for (std::size_t i = 0; 8 * i < row * layout_.height; ++i) {
                const std::uint64_t value = word(sequence, layout_.planes[p].product, i);
                std::memcpy(dense_.data() + 8 * i, &value, 8);
            }
            buffers_[p].resize(stride * layout_.height);
            for (std::size_t y = 0; y < layout_.height; ++y) {
                std::memcpy(buffers_[p].data() + y * stride, dense_.data() + y * row, row);
            }
            planes_.push_back({layout_.planes[p].product, buffers_[p].data(), row, stride});
        }
        return planes_;
    }

private:
    disparityd::proto::ShmLayout layout_;
    std::vector<std::uint8_t> dense_;
    std::vector<std::vector<std::uint8_t>> buffers_;
    std::vector<disparityd::proto::PlaneSource> planes_;
};

/// A value that no other field of the frame has and that fits every type.
template <typename T>
T field_value(std::uint64_t sequence, int index) {
    return static_cast<T>(static_cast<double>(sequence % 1000) + 0.125 + 17 * index);
}

/// Every field follows from the sequence number too.
inline disparityd::proto::FrameInfo head(std::uint64_t sequence, const disparityd::proto::ShmLayout& layout) {
    disparityd::proto::FrameInfo frame{};
    int index = 0;
#define PATTERN_FIELD(name) frame.name = field_value<decltype(frame.name)>(sequence, index++);
    DISPARITYD_FRAME_FIELDS(PATTERN_FIELD, PATTERN_FIELD)
#undef PATTERN_FIELD
    frame.sequence = sequence;
    frame.publish_index = sequence + 7;
    frame.width = layout.width;
    frame.height = layout.height;
    return frame;
}

/// Empty, or where a plane is not that of the sequence number.
inline std::string check_plane(std::uint64_t sequence, std::uint32_t product, const std::vector<std::uint8_t>& bytes) {
    for (std::size_t i = 0; 8 * i < bytes.size(); ++i) {
        const std::uint64_t value = word(sequence, product, i);
        const std::size_t part = bytes.size() - 8 * i < 8 ? bytes.size() - 8 * i : 8;
        if (std::memcmp(bytes.data() + 8 * i, &value, part) != 0) {
            return "frame " + std::to_string(sequence) + ", product " + std::to_string(product) + ", byte " +
                   std::to_string(8 * i);
        }
    }
    return {};
}

/// A name of its own for each test process and purpose.
inline std::string unique_name(const std::string& purpose, int pid) {
    return "test." + purpose + "." + std::to_string(pid);
}

}  // namespace pattern
