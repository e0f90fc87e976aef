// SPDX-License-Identifier: Apache-2.0
#include "pipeline/aligned_buffer.h"

#include <cstring>
#include <new>
#include <stdexcept>
#include <string>

namespace disparityd::pipeline {

AlignedBuffer::AlignedBuffer(std::size_t bytes) : size_(bytes) {
    if (bytes == 0) {
        return;
    }
    constexpr std::size_t alignment = 64;
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    bytes_.reset(static_cast<std::byte*>(std::aligned_alloc(alignment, rounded)));
    if (!bytes_) {
        throw std::runtime_error("no memory for a frame buffer of " + std::to_string(rounded >> 20) +
                                 " MB: use a smaller rectified size or fewer pipeline slots");
    }
    std::memset(bytes_.get(), 0, rounded);
}

}  // namespace disparityd::pipeline
