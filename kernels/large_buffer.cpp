// SPDX-License-Identifier: Apache-2.0
#include "kernels/large_buffer.h"

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include <sys/mman.h>

namespace disparityd {

namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;

/// nullptr when the system refuses.
std::byte* map(std::size_t size) {
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? nullptr : static_cast<std::byte*>(memory);
}

/// `size` is a multiple of a large page. Maps one more and gives back what lies before and behind.
std::byte* map_aligned(std::size_t size) {
    std::byte* const memory = map(size + large_page);
    if (memory == nullptr) {
        return nullptr;
    }
    const std::size_t before = (large_page - reinterpret_cast<std::uintptr_t>(memory) % large_page) % large_page;
    const std::size_t behind = large_page - before;
    if (before > 0) {
        munmap(memory, before);
    }
    munmap(memory + before + size, behind);
    // Not in every kernel, and never a reason to fail.
    madvise(memory + before, size, MADV_HUGEPAGE);
    return memory + before;
}

}  // namespace

LargeBuffer::LargeBuffer(std::size_t size) : size_(size), mapped_(size) {
    if (size == 0) {
        return;
    }
    if (size >= large_page) {
        mapped_ = (size + large_page - 1) / large_page * large_page;
        data_ = map_aligned(mapped_);
    } else {
        data_ = map(size);
    }
    if (data_ == nullptr) {
        throw std::runtime_error("matching needs " + std::to_string((size - 1) / 1000000 + 1) +
                                 " MB of memory at once and the system has not got them: choose a smaller image or "
                                 "fewer disparities");
    }
}

LargeBuffer::~LargeBuffer() {
    if (data_ != nullptr) {
        munmap(data_, mapped_);
    }
}

LargeBuffer::LargeBuffer(LargeBuffer&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)),
      size_(std::exchange(other.size_, 0)),
      mapped_(std::exchange(other.mapped_, 0)) {}

LargeBuffer& LargeBuffer::operator=(LargeBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(mapped_, other.mapped_);
    return *this;
}

}  // namespace disparityd
