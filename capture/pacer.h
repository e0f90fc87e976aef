// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace disparityd::capture {

/// Says when replayed frames are due on the steady clock. A time follows from the one before, so that delays do not add
/// up. A taker that comes more than a second late sets the clock back, so that frames do not come in a burst. Its owner
/// locks it.
class Pacer {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Returns when the next frame is due: the first one `now`, every other one `step` after the one before. To be
    /// called once for each frame, at the time `now` at which the taker asks for it.
    Time due(Time now, std::chrono::nanoseconds step) {
        constexpr std::chrono::seconds latest{1};
        due_ = started_ ? due_ + step : now;
        started_ = true;
        if (now - due_ > latest) {
            due_ = now;
        }
        return due_;
    }

private:
    Time due_{};
    bool started_ = false;
};

/// The step from a frame recorded at `before_ns` to one recorded at `time_ns`. It is `period` where the time does not
/// rise, and at most a day: a damaged recording may hold any two times.
inline std::chrono::nanoseconds recorded_step(std::int64_t before_ns, std::int64_t time_ns,
                                              std::chrono::nanoseconds period) {
    if (time_ns <= before_ns) {
        return period;
    }
    // Unsigned: two times may be further apart than a signed number holds.
    const std::uint64_t apart = static_cast<std::uint64_t>(time_ns) - static_cast<std::uint64_t>(before_ns);
    constexpr std::uint64_t day = 86'400'000'000'000U;
    return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(apart, day)));
}

}  // namespace disparityd::capture
