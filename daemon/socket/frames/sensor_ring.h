// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <vector>

#include "capture/sensor_sample.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// The newest samples of the camera's sensors, kept once for all clients, as FrameRing keeps frames. A client keeps
/// only its position. One thread (the server's).
class SensorRing {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Adds samples, the last one measured at `newest`. Drops the oldest beyond the capacity.
    void put(const std::vector<capture::SensorSample>& samples, Time newest);

    /// Returns the number of the newest sample plus one; samples are counted from 0.
    std::uint64_t end() const { return end_; }

    /// Fills the message with all samples from number `from` on; its `skipped` counts those that were
    /// dropped. Returns end().
    std::uint64_t fill(std::uint64_t from, v1::Sensors& message) const;

    /// Five seconds of a ZED 2; as one message, far below the largest Envelope.
    static constexpr std::size_t capacity = 2048;

private:
    std::deque<capture::SensorSample> samples_;
    std::uint64_t end_ = 0;
    Time newest_{};
};

}  // namespace disparityd::daemon
