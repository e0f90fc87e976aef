// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/failing_memory.h"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

#include <pthread.h>

namespace {

std::atomic<bool> failing{false};
std::atomic<std::uint64_t> asked{0};
std::atomic<std::uint64_t> refused{0};
std::atomic<std::uint64_t> first_refused{0};
std::atomic<std::uint64_t> refused_count{0};
std::atomic<std::size_t> most_bytes{0};
std::atomic<std::size_t> least_refused{0};  ///< bytes
std::atomic<pthread_t> spared{};

bool refuses(std::size_t size) {
    if (!failing.load(std::memory_order_acquire) || pthread_equal(pthread_self(), spared.load()) != 0) {
        return false;
    }
    for (std::size_t most = most_bytes; most < size && !most_bytes.compare_exchange_weak(most, size);) {
    }
    if (size < least_refused.load()) {
        return false;
    }
    const std::uint64_t number = asked.fetch_add(1);
    if (number < first_refused.load() || number - first_refused.load() >= refused_count.load()) {
        return false;
    }
    refused.fetch_add(1);
    return true;
}

void start(std::uint64_t first, std::uint64_t count, std::size_t bytes) {
    spared = pthread_self();
    first_refused = first;
    refused_count = count;
    least_refused = bytes;
    asked = 0;
    refused = 0;
    most_bytes = 0;
    failing.store(true, std::memory_order_release);
}

}  // namespace

namespace disparityd::test::failing_memory {

void fail(std::uint64_t first, std::uint64_t count) {
    start(first, count, 0);
}

void fail_above(std::size_t bytes) {
    start(0, std::numeric_limits<std::uint64_t>::max(), bytes + 1);
}

std::uint64_t stop() {
    failing.store(false, std::memory_order_release);
    return refused.load();
}

std::size_t largest() {
    return most_bytes.load();
}

}  // namespace disparityd::test::failing_memory

void* operator new(std::size_t size) {
    void* const memory = refuses(size) ? nullptr : std::malloc(size == 0 ? 1 : size);
    if (memory == nullptr) {
        throw std::bad_alloc();
    }
    return memory;
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
