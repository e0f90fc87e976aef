// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <vector>

#include "pipeline/heartbeat.h"

namespace disparityd::pipeline {

/// Decides when a live pipeline begins its next frame: when the frames before it leave it the cores, not before. One
/// that began earlier would wait behind them and grow old, while a newer one comes. With one worker that is when no
/// other frame is being computed. With several it is so early that no stage waits for the frame, and so late that the
/// frame waits in front of no stage, as far as the times of the frames before tell.
///
/// Allocates nothing after the constructor. Any thread.
class Admission {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// `stages`: the threads that a frame passes. `computing`: the first so many of them use workers. `frames`: how
    /// many may be in flight.
    Admission(std::size_t stages, std::size_t computing, std::size_t frames, int workers);

    /// A stage begins the oldest frame in front of it. Called again when it had to wait for a worker: its time counts
    /// from then. A stage 0 begins a new frame.
    void begins(std::size_t stage, Time now);
    /// A stage hands its frame to the next one; from the last stage the frame leaves.
    void ends(std::size_t stage, Time now);

    /// Returns when the next frame may begin, as far as is known at `now`, and not before `now`; nothing: not before
    /// another frame has moved on.
    std::optional<Time> opens(Time now) const;

    /// Waits until the next frame may begin; `heartbeat` beats meanwhile.
    void wait(Heartbeat& heartbeat);

private:
    using Duration = Time::duration;

    struct Frame {
        std::size_t stage = 0;  ///< that it is in, or in front of
        std::optional<Time> begun;
    };

    /// The next two: under the lock.
    std::vector<Frame>::iterator oldest_of(std::size_t stage);
    std::optional<Time> opens_locked(Time now) const;

    const std::size_t computing_;
    const bool one_worker_;
    mutable std::mutex mutex_;  ///< all below
    std::condition_variable moved_;
    std::vector<Frame> frames_;        ///< in flight, the oldest first
    std::vector<Duration> durations_;  ///< per stage: an average that follows the frames; 0 = none has passed
    mutable std::vector<Time> free_;   ///< per stage; memory of opens_locked()
};

}  // namespace disparityd::pipeline
