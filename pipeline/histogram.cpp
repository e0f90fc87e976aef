// SPDX-License-Identifier: Apache-2.0
#include "pipeline/histogram.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace disparityd::pipeline {

namespace {

// Returns b = 8 * e + m for a time in [(8 + m) * 2^e, (9 + m) * 2^e) / 8 microseconds: linear within a doubling.
std::size_t bucket_of(std::uint64_t ns, std::size_t buckets) {
    const std::uint64_t eighths = std::max<std::uint64_t>(8, ns * 8 / 1000);
    const int doubling = static_cast<int>(std::bit_width(eighths)) - 4;
    const std::uint64_t step = (eighths >> doubling) - 8;
    return std::min<std::size_t>(static_cast<std::size_t>(doubling) * 8 + step, buckets - 1);
}

double bucket_middle_us(std::size_t bucket) {
    const double step = static_cast<double>(bucket % 8);
    return std::ldexp((8.5 + step) / 8.0, static_cast<int>(bucket / 8));
}

/// Returns the index of the first bound that is not exceeded; the number of bounds where all are.
std::size_t bound_of(std::uint64_t ns) {
    constexpr std::uint64_t ns_per_us = 1000;
    std::size_t bound = 0;
    while (bound < duration_bounds_us.size() && ns > duration_bounds_us[bound] * ns_per_us) {
        ++bound;
    }
    return bound;
}

}  // namespace

void Histogram::record(std::chrono::nanoseconds time) {
    const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, time.count()));
    counts_[bucket_of(ns, counts_.size())].fetch_add(1, std::memory_order_relaxed);
    bounded_[bound_of(ns)].fetch_add(1, std::memory_order_relaxed);
    sum_ns_.fetch_add(ns, std::memory_order_relaxed);
    if (ns > max_ns_.load(std::memory_order_relaxed)) {
        max_ns_.store(ns, std::memory_order_relaxed);
    }
}

HistogramSummary Histogram::summary() const {
    std::array<std::uint64_t, std::tuple_size_v<decltype(counts_)>> counts;
    HistogramSummary summary;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        counts[i] = counts_[i].load(std::memory_order_relaxed);
        summary.count += counts[i];
    }
    if (summary.count == 0) {
        return summary;
    }
    summary.mean =
        static_cast<double>(sum_ns_.load(std::memory_order_relaxed)) / 1000.0 / static_cast<double>(summary.count);
    summary.max = static_cast<double>(max_ns_.load(std::memory_order_relaxed)) / 1000.0;
    const auto quantile = [&](double q) {
        const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(summary.count)));
        std::uint64_t seen = 0;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            seen += counts[i];
            if (seen >= rank) {
                return std::min(bucket_middle_us(i), summary.max);
            }
        }
        return summary.max;
    };
    summary.p50 = quantile(0.50);
    summary.p90 = quantile(0.90);
    summary.p99 = quantile(0.99);
    return summary;
}

HistogramTotals Histogram::totals() const {
    HistogramTotals totals;
    totals.sum_ns = sum_ns_.load(std::memory_order_relaxed);
    for (std::size_t i = 0; i < totals.up_to.size(); ++i) {
        totals.count += bounded_[i].load(std::memory_order_relaxed);
        totals.up_to[i] = totals.count;
    }
    totals.count += bounded_.back().load(std::memory_order_relaxed);
    return totals;
}

}  // namespace disparityd::pipeline
