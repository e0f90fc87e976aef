// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/daemon_clock.h"

#include <algorithm>
#include <limits>
#include <span>

namespace disparity {
namespace {

/// Two clocks drift apart by less than one part in so many: an old answer bounds less.
constexpr std::int64_t drift = 5000;

}  // namespace

void DaemonClock::add(std::int64_t before_ns, std::int64_t daemon_ns, std::int64_t after_ns) {
    answers_[count_ % answers_.size()] = {after_ns, daemon_ns - after_ns, daemon_ns - before_ns};
    ++count_;
}

std::int64_t DaemonClock::latest(std::int64_t now_ns) const {
    std::int64_t most = std::numeric_limits<std::int64_t>::max();
    std::int64_t least = std::numeric_limits<std::int64_t>::min();
    for (const Answer& answer : std::span(answers_).first(std::min(count_, answers_.size()))) {
        const std::int64_t drifted = std::max<std::int64_t>(now_ns - answer.at_ns, 0) / drift;
        most = std::min(most, answer.most_ns + drifted);
        least = std::max(least, answer.least_ns - drifted);
    }
    return least <= 0 && most >= 0 ? now_ns : now_ns + most;
}

std::int64_t DaemonClock::round_trip() const {
    std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
    for (const Answer& answer : std::span(answers_).first(std::min(count_, answers_.size()))) {
        shortest = std::min(shortest, answer.most_ns - answer.least_ns);
    }
    return shortest;
}

}  // namespace disparity
