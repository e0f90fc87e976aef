// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <climits>
#include <cstdint>

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

namespace disparityd::proto {

static_assert(sizeof(std::atomic<std::uint32_t>) == 4, "a futex word is 32 bits");

/// Sleeps while the word has the value, for `timeout` at most. Works across processes (no FUTEX_PRIVATE_FLAG) and on a
/// read-only mapping. May return early without a reason.
inline void futex_wait(const std::atomic<std::uint32_t>& word, std::uint32_t value, std::chrono::nanoseconds timeout) {
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
    timespec relative{};
    relative.tv_sec = seconds.count();
    relative.tv_nsec = (timeout - seconds).count();
    syscall(SYS_futex, &word, FUTEX_WAIT, value, &relative, nullptr, 0);
}

/// Wakes threads that wait on the word, in all processes, but not more than `most`. Returns how many it woke.
inline int futex_wake(std::atomic<std::uint32_t>& word, int most = INT_MAX) {
    return static_cast<int>(syscall(SYS_futex, &word, FUTEX_WAKE, most, nullptr, nullptr, 0));
}

}  // namespace disparityd::proto
