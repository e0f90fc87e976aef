// SPDX-License-Identifier: Apache-2.0
#include "obstacles/given_levels.h"

#include <cmath>

namespace disparityd::scan {
namespace {

/// Returns the direction so much of the way from one to another.
RobotUp between(const RobotUp& a, const RobotUp& b, double part) {
    const RobotUp sum{a.ahead + part * (b.ahead - a.ahead), a.left + part * (b.left - a.left),
                      a.up + part * (b.up - a.up)};
    const double length = std::hypot(sum.ahead, sum.left, sum.up);
    return {sum.ahead / length, sum.left / length, sum.up / length};  // not a number where they are opposite
}

}  // namespace

std::optional<RobotUp> checked_up(const RobotUp& up) {
    const double length = std::hypot(up.ahead, up.left, up.up);
    if (!(std::abs(length - 1) <= 0.1)) {  // not a number fails, too
        return std::nullopt;
    }
    return RobotUp{up.ahead / length, up.left / length, up.up / length};
}

void GivenLevels::add(std::int64_t monotonic_ns, const RobotUp& up) {
    const std::lock_guard lock(mutex_);
    if (count_ > 0 && monotonic_ns <= at(count_ - 1).monotonic_ns) {
        return;
    }
    if (count_ == most) {
        begin_ = (begin_ + 1) % most;
        --count_;
    }
    levels_[(begin_ + count_) % most] = {monotonic_ns, up};
    ++count_;
}

std::optional<RobotUp> GivenLevels::up_at(std::int64_t monotonic_ns) const {
    const std::lock_guard lock(mutex_);
    std::size_t later = count_;
    while (later > 0 && at(later - 1).monotonic_ns > monotonic_ns) {
        --later;
    }
    const Level* const before =
        later > 0 && monotonic_ns - at(later - 1).monotonic_ns <= fresh_ns ? &at(later - 1) : nullptr;
    const Level* const after =
        later < count_ && at(later).monotonic_ns - monotonic_ns <= fresh_ns ? &at(later) : nullptr;
    if (before == nullptr || after == nullptr) {
        const Level* const one = before != nullptr ? before : after;
        return one != nullptr ? std::optional(one->up) : std::nullopt;
    }
    const auto passed = static_cast<double>(monotonic_ns - before->monotonic_ns);
    return between(before->up, after->up, passed / static_cast<double>(after->monotonic_ns - before->monotonic_ns));
}

std::optional<std::int64_t> GivenLevels::newest_ns() const {
    const std::lock_guard lock(mutex_);
    return count_ > 0 ? std::optional(at(count_ - 1).monotonic_ns) : std::nullopt;
}

}  // namespace disparityd::scan
