// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <vector>

#include "capture/sensor_sample.h"
#include "proto/disparity.pb.h"

namespace disparityd {

/// The newest samples of the camera's sensors, kept once for all clients, as FrameRing keeps frames: each client
/// remembers only how far it has read. One thread (the server's).
class SensorRing {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// `newest` is when the last of them was measured; the oldest samples make room.
    void put(const std::vector<capture::SensorSample>& samples, Time newest);

    /// One more than the number of the newest sample; samples are counted from 0.
    std::uint64_t end() const { return end_; }

    /// Samples from number `from` on into a message, all that are there; how many of them have made room already
    /// stands in it. Returns end().
    std::uint64_t fill(std::uint64_t from, v1::Sensors& message) const;

    /// Five seconds of a ZED 2; as one message, far below the largest Envelope.
    static constexpr std::size_t capacity = 2048;

private:
    std::deque<capture::SensorSample> samples_;
    std::uint64_t end_ = 0;
    Time newest_{};
};

}  // namespace disparityd
