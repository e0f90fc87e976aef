// SPDX-License-Identifier: Apache-2.0
#include "tests/kernels/check/cycle_counter.h"

#include <linux/perf_event.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace disparityd::test {

CycleCounter::CycleCounter() {
    perf_event_attr event{};
    event.type = PERF_TYPE_HARDWARE;
    event.size = sizeof event;
    event.config = PERF_COUNT_HW_CPU_CYCLES;
    event.exclude_kernel = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &event, 0, -1, -1, 0));
    if (file_ >= 0) {
        unit_ = "cycles";
        return;
    }
#if defined(__x86_64__)
    unit_ = "TSC ticks";
#endif
}

CycleCounter::~CycleCounter() {
    if (file_ >= 0) {
        close(file_);
    }
}

std::uint64_t CycleCounter::now() const {
    std::uint64_t count = 0;
    if (file_ >= 0) {
        return read(file_, &count, sizeof count) == sizeof count ? count : 0;
    }
#if defined(__x86_64__)
    count = __rdtsc();
#endif
    return count;
}

}  // namespace disparityd::test
