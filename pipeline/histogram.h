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

/// A histogram of durations with logarithmic buckets (8 per doubling, about 9 % wide), 1 us to 70 minutes. One thread
/// records, any thread reads; nothing is allocated.
class Histogram {
public:
    void record(std::chrono::nanoseconds time);
    HistogramSummary summary() const;

private:
    static constexpr int buckets_per_doubling = 8;
    static constexpr int doublings = 32;
    std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(buckets_per_doubling* doublings)> counts_{};
    std::atomic<std::uint64_t> sum_ns_{0};
    std::atomic<std::uint64_t> max_ns_{0};
};

}  // namespace disparityd::pipeline
