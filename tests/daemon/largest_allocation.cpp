// SPDX-License-Identifier: Apache-2.0
#include "tests/daemon/largest_allocation.h"

#include <atomic>
#include <cstdlib>
#include <new>

#include <pthread.h>

namespace {

std::atomic<std::size_t> most_bytes{0};
std::atomic<pthread_t> spared{};

void note(std::size_t size) {
    if (pthread_equal(pthread_self(), spared.load()) == 0) {
        for (std::size_t most = most_bytes; most < size && !most_bytes.compare_exchange_weak(most, size);) {
        }
    }
}

}  // namespace

namespace disparityd::test::largest_allocation {

void reset() {
    spared = pthread_self();
    most_bytes = 0;
}

std::size_t bytes() {
    return most_bytes.load();
}

}  // namespace disparityd::test::largest_allocation

void* operator new(std::size_t size) {
    note(size);
    void* const memory = std::malloc(size == 0 ? 1 : size);
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
