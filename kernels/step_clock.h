// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <span>

namespace disparityd {

/// Sets each of its entries to the time since the one before.
class StepClock {
public:
    explicit StepClock(std::span<std::chrono::nanoseconds> times)
        : times_(times), last_(std::chrono::steady_clock::now()) {}
    void next() {
        const auto now = std::chrono::steady_clock::now();
        times_[step_++] = now - last_;
        last_ = now;
    }

private:
    std::span<std::chrono::nanoseconds> times_;
    std::chrono::steady_clock::time_point last_;
    std::size_t step_ = 0;
};

}  // namespace disparityd
