// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace disparityd::test {

/// Processor cycles of this thread where the system lets them be read (perf_event_open); else, on x86, ticks of the
/// time-stamp counter, which run at a constant rate; else nothing.
class CycleCounter {
public:
    CycleCounter();
    ~CycleCounter();
    CycleCounter(const CycleCounter&) = delete;
    CycleCounter& operator=(const CycleCounter&) = delete;

    /// "cycles", "TSC ticks", or empty.
    const std::string& unit() const { return unit_; }
    std::uint64_t now() const;

private:
    int file_ = -1;
    std::string unit_;
};

}  // namespace disparityd::test
