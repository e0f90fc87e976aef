// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/allocation_meter.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include <malloc.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

std::atomic<bool> counting{false};
std::atomic<std::int64_t> held{0};
std::atomic<std::int64_t> max_held{0};

void add(std::int64_t bytes) {
    if (!counting.load(std::memory_order_relaxed)) {
        return;
    }
    const std::int64_t now = held.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    std::int64_t most = max_held.load(std::memory_order_relaxed);
    while (now > most && !max_held.compare_exchange_weak(most, now, std::memory_order_relaxed)) {
    }
}

}  // namespace

#ifdef DISPARITYD_BENCH_COUNTS_ALLOCATIONS

namespace {

void* allocated(void* memory) {
    add(static_cast<std::int64_t>(malloc_usable_size(memory)));
    return memory;
}

void released(void* memory) {
    add(-static_cast<std::int64_t>(malloc_usable_size(memory)));
}

}  // namespace

// The C library's own names for what these replace; operator new ends in malloc too. What the library itself maps for
// malloc does not come through mmap here and is not counted twice.
extern "C" {
// NOLINTBEGIN(bugprone-reserved-identifier)
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
// NOLINTEND(bugprone-reserved-identifier)

void* malloc(std::size_t size) noexcept {
    return allocated(__libc_malloc(size));
}
void* calloc(std::size_t number, std::size_t size) noexcept {
    return allocated(__libc_calloc(number, size));
}
void* realloc(void* old, std::size_t size) noexcept {
    released(old);
    return allocated(__libc_realloc(old, size));
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
    return allocated(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
    return allocated(__libc_memalign(alignment, size));
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
    *memory = allocated(__libc_memalign(alignment, size));
    return *memory != nullptr ? 0 : ENOMEM;
}
void free(void* memory) {
    released(memory);
    __libc_free(memory);
}
void* mmap(void* address, std::size_t size, int protection, int flags, int file, off_t offset) {
    const long result = syscall(SYS_mmap, address, size, protection, flags, file, offset);
    if (result != -1 && (flags & MAP_ANONYMOUS) != 0) {
        add(static_cast<std::int64_t>(size));
    }
    return reinterpret_cast<void*>(result);  // NOLINT(performance-no-int-to-ptr): what the system call gives
}
int munmap(void* address, std::size_t size) {
    add(-static_cast<std::int64_t>(size));
    return static_cast<int>(syscall(SYS_munmap, address, size));
}
}

#endif

namespace disparityd::bench {

AllocationMeter::AllocationMeter() {
    held = 0;
    max_held = 0;
    counting = true;
}

AllocationMeter::~AllocationMeter() {
    counting = false;
}

std::optional<std::int64_t> AllocationMeter::peak_bytes() const {
#ifdef DISPARITYD_BENCH_COUNTS_ALLOCATIONS
    return max_held.load();
#else
    return std::nullopt;
#endif
}

}  // namespace disparityd::bench
