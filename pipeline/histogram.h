// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

namespace disparityd::pipeline {

/// Durations in microseconds.
struct HistogramSummary {
    std::uint64_t count = 0;
    double mean = 0;
    double p50 = 0;
    double p90 = 0;
    double p99 = 0;
    double max = 0;
};

/// The upper bounds that durations are counted by, in microseconds: a 1-2-5 series from 0.1 ms to 1 s. Monitoring
/// compares daemons, so they are the same for every step, machine and configuration.
inline constexpr std::array<std::uint32_t, 13> duration_bounds_us{
    100, 200, 500, 1'000, 2'000, 5'000, 10'000, 20'000, 50'000, 100'000, 200'000, 500'000, 1'000'000};

/// Counts that never fall, for monitoring. A snapshot agrees with itself: up_to rises from bound to bound, up to count.
struct HistogramTotals {
    std::array<std::uint64_t, duration_bounds_us.size()> up_to{};  ///< how many lasted at most as long as each bound
    std::uint64_t count = 0;
    std::uint64_t sum_ns = 0;  ///< exact; one that is recorded meanwhile may be in it or in `count` alone
};

/// A histogram of durations with logarithmic buckets (8 per doubling, about 9 % wide), 1 us to 70 minutes. One thread
/// records, any thread reads; nothing is allocated.
class Histogram {
public:
    void record(std::chrono::nanoseconds time);
    HistogramSummary summary() const;
    HistogramTotals totals() const;

private:
    static constexpr int buckets_per_doubling = 8;
    static constexpr int doublings = 32;
    std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(buckets_per_doubling* doublings)> counts_{};
    std::array<std::atomic<std::uint64_t>, duration_bounds_us.size() + 1> bounded_{};  ///< by duration_bounds_us
    std::atomic<std::uint64_t> sum_ns_{0};
    std::atomic<std::uint64_t> max_ns_{0};
};

}  // namespace disparityd::pipeline
