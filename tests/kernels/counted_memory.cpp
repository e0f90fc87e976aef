// SPDX-License-Identifier: Apache-2.0
#include "tests/kernels/counted_memory.h"

#include <atomic>
#include <cerrno>

#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

std::atomic<std::size_t> call_count{0};
std::atomic<std::size_t> byte_count{0};

void count(std::size_t bytes) {
    call_count.fetch_add(1, std::memory_order_relaxed);
    byte_count.fetch_add(bytes, std::memory_order_relaxed);
}

}  // namespace

// The C library's own names for what these replace; operator new ends in malloc too.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
    count(size);
    return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) noexcept {
    count(number * size);
    return __libc_calloc(number, size);
}
void* realloc(void* old, std::size_t size) noexcept {
    count(size);
    return __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
    count(size);
    return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
    count(size);
    return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
    count(size);
    *memory = __libc_memalign(alignment, size);
    return *memory != nullptr ? 0 : ENOMEM;
}
void* mmap(void* address, std::size_t size, int protection, int flags, int file, off_t offset) noexcept {
    count(size);
    return reinterpret_cast<void*>(  // NOLINT(performance-no-int-to-ptr)
        syscall(SYS_mmap, address, size, protection, flags, file, offset));
}
}

namespace disparityd::test::counted_memory {

void reset() {
    call_count = 0;
    byte_count = 0;
}

std::size_t calls() {
    return call_count;
}

std::size_t bytes() {
    return byte_count;
}

}  // namespace disparityd::test::counted_memory
