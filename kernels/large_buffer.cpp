// SPDX-License-Identifier: Apache-2.0
#include "kernels/large_buffer.h"

#include <stdexcept>
#include <string>
#include <utility>

#include <sys/mman.h>

namespace disparityd {

LargeBuffer::LargeBuffer(std::size_t size) : size_(size) {
    if (size == 0) {
        return;
    }
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        throw std::runtime_error("matching needs " + std::to_string((size - 1) / 1000000 + 1) +
                                 " MB of memory at once and the system has not got them: choose a smaller image or "
                                 "fewer disparities");
    }
    madvise(memory, size, MADV_HUGEPAGE);
    data_ = static_cast<std::byte*>(memory);
}

LargeBuffer::~LargeBuffer() {
    if (data_ != nullptr) {
        munmap(data_, size_);
    }
}

LargeBuffer::LargeBuffer(LargeBuffer&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

LargeBuffer& LargeBuffer::operator=(LargeBuffer&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
}

}  // namespace disparityd
