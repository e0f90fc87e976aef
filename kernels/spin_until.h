// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace disparityd {

/// Tells the processor that the thread only waits; Highway has it for x86 alone.
inline void pause_processor() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

/// Spins until `reached()` is true, 50 microseconds at most: as long as falling asleep and being woken would take.
/// Returns whether it became true. Callers that have to wait longer sleep.
template <class Reached>
bool spin_until(Reached reached) {
    constexpr std::chrono::microseconds patience(50);
    constexpr int looks_per_time = 16;
    if (reached()) {
        return true;
    }
    const auto end = std::chrono::steady_clock::now() + patience;
    do {
        for (int i = 0; i < looks_per_time; ++i) {
            pause_processor();
            if (reached()) {
                return true;
            }
        }
    } while (std::chrono::steady_clock::now() < end);
    return false;
}

}  // namespace disparityd
