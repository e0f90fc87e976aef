// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace disparityd::pipeline {

/// Measures events per second over the last five seconds. One thread ticks, any thread reads.
class RateMeter {
public:
    void tick(std::chrono::steady_clock::time_point now);
    double per_second(std::chrono::steady_clock::time_point now) const;

private:
    static constexpr std::int64_t window_ns = 5'000'000'000;
    std::array<std::atomic<std::int64_t>, 1024> times_ns_{};
    std::atomic<std::uint64_t> ticks_{0};
};

}  // namespace disparityd::pipeline
