// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rate_meter.h"

#include <algorithm>

namespace disparityd::pipeline {

namespace {

std::int64_t ns(std::chrono::steady_clock::time_point time) {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
}

}  // namespace

void RateMeter::tick(std::chrono::steady_clock::time_point now) {
    const std::uint64_t tick = ticks_.load(std::memory_order_relaxed);
    times_ns_[tick % times_ns_.size()].store(ns(now), std::memory_order_relaxed);
    ticks_.store(tick + 1, std::memory_order_release);
}

double RateMeter::per_second(std::chrono::steady_clock::time_point now) const {
    const std::uint64_t ticks = ticks_.load(std::memory_order_acquire);
    // One entry less than the ring holds: tick() may overwrite the oldest meanwhile.
    const std::uint64_t available = std::min<std::uint64_t>(ticks, times_ns_.size() - 1);
    std::uint64_t events = 0;
    std::int64_t oldest = 0;
    for (std::uint64_t back = 1; back <= available; ++back) {
        const std::int64_t time = times_ns_[(ticks - back) % times_ns_.size()].load(std::memory_order_relaxed);
        if (ns(now) - time > window_ns) {
            break;
        }
        oldest = time;
        ++events;
    }
    if (events < 2) {
        return 0;
    }
    // The interval since the newest event counts once it is longer than the average: so a stopped source decays.
    const std::int64_t newest = times_ns_[(ticks - 1) % times_ns_.size()].load(std::memory_order_relaxed);
    const double intervals = static_cast<double>(events - 1);
    const double mean = static_cast<double>(newest - oldest) / intervals;
    const double running = static_cast<double>(ns(now) - newest);
    const double span = static_cast<double>(newest - oldest) + std::max(0.0, running - mean);
    return span > 0 ? intervals * 1e9 / span : 0;
}

}  // namespace disparityd::pipeline
