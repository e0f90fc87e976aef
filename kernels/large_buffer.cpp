// SPDX-License-Identifier: Apache-2.0
#include "kernels/large_buffer.h"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include <sys/mman.h>
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#include <sanitizer/asan_interface.h>
#endif
#endif

namespace disparityd {

namespace {

constexpr std::size_t large_page = std::size_t{2} << 20;

/// All buffers: where they begin, and their bytes.
struct Buffers {
    std::mutex mutex;
    std::map<std::byte*, std::size_t> bytes;
};

Buffers& buffers() {
    static auto* const all = new Buffers;  // static buffers may end after it would
    return *all;
}

/// Nobody may use what was mapped behind the end, up to a page or a large page; the address sanitizer is told so.
void close_tail([[maybe_unused]] std::byte* data, [[maybe_unused]] std::size_t size, [[maybe_unused]] bool closed,
                [[maybe_unused]] std::size_t mapped) {
#if defined(ASAN_POISON_MEMORY_REGION)
    constexpr std::size_t page = 4096;
    const std::size_t end = (mapped + page - 1) / page * page;
    if (closed) {
        ASAN_POISON_MEMORY_REGION(data + size, end - size);
    } else {
        ASAN_UNPOISON_MEMORY_REGION(data + size, end - size);
    }
#endif
}

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

/// MADV_POPULATE_WRITE, which older headers lack.
constexpr int populate_write = 23;

[[noreturn]] void refuse(std::size_t size) {
    throw std::runtime_error("matching needs " + std::to_string((size - 1) / 1000000 + 1) +
                             " MB of memory at once and the system has not got them: choose a smaller image, "
                             "fewer disparities or fewer slots");
}

/// Writes to each page what it holds; those of a closed tail, too.
__attribute__((no_sanitize("address"))) void touch(std::byte* data, std::size_t bytes) {
    constexpr std::size_t page = 4096;
    for (std::size_t i = 0; i < bytes; i += page) {
        __atomic_fetch_or(reinterpret_cast<unsigned char*>(data) + i, 0, __ATOMIC_RELAXED);
    }
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
        refuse(size);
    }
    {
        const std::lock_guard lock(buffers().mutex);
        buffers().bytes.emplace(data_, mapped_);
    }
    close_tail(data_, size_, true, mapped_);
}

LargeBuffer::~LargeBuffer() {
    if (data_ != nullptr) {
        close_tail(data_, size_, false, mapped_);
        const std::lock_guard lock(buffers().mutex);
        buffers().bytes.erase(data_);
        munmap(data_, mapped_);
    }
}

std::size_t large_memory_held() {
    const std::lock_guard lock(buffers().mutex);
    std::size_t held = 0;
    for (const auto& [_, bytes] : buffers().bytes) {
        held += bytes;
    }
    return held;
}

void fault_in_large_memory() {
    const std::lock_guard lock(buffers().mutex);
    for (const auto& [data, bytes] : buffers().bytes) {
        if (madvise(data, bytes, populate_write) == 0) {
            continue;
        }
        if (errno == ENOMEM || errno == EFAULT) {
            refuse(bytes);
        }
        touch(data, bytes);  // a kernel before 5.14
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
