// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace disparityd::capture {

/// Maps a camera's clock to the host's CLOCK_MONOTONIC from the arrival times of samples. Makes no system calls; one
/// thread.
///
/// A sample may arrive late, but never earlier than the shortest delay allows. So the least-delayed sample of every
/// second counts. A robust line through those of the last minute gives how much faster one clock runs than the other;
/// no sample lies below it. The shortest delay itself cannot be known, for a device on USB about a millisecond: mapped
/// times are late by that much.
class SensorClock {
public:
    /// Returns when a sample with this camera time was measured, on the host's clock: never after it arrived, and later
    /// than the sample before. Returns nullopt for the first samples of a clock, which are too few to map it. A camera
    /// clock that jumps (a restarted camera) begins anew.
    std::optional<std::int64_t> map(std::int64_t camera_ns, std::int64_t arrived_ns);

    /// Says that the next sample is of another clock, such as that of another camera. Times go on rising.
    void forget() { begun_ = false; }

    /// Returns how often the camera's clock has begun anew, its first time and forget() not counted.
    std::uint64_t jumps() const { return jumps_; }

    /// Returns by how much the host's clock runs faster than the camera's, as far as it is known: 1e-6 is a microsecond
    /// in a second.
    double drift() const { return drift_; }

    /// Samples of a new clock that map() gives no time for.
    static constexpr int settling_samples = 64;

private:
    /// The quickest sample of a second: when on the camera's clock, counted from origin_, and how much later on the
    /// host's.
    struct Quickest {
        double camera = 0;
        double apart = 0;
    };
    static constexpr std::size_t most_seconds = 64;

    void begin(std::int64_t camera_ns, std::int64_t arrived_ns);
    bool jumped(std::int64_t camera_ns, std::int64_t arrived_ns) const;
    double line(double camera) const { return offset_ + drift_ * camera; }
    void close_second();
    void fit();

    bool begun_ = false;
    std::uint64_t jumps_ = 0;
    int samples_ = 0;
    int late_seconds_ = 0;  ///< in a row, in which every sample came far too late
    std::int64_t camera_origin_ = 0;
    std::int64_t host_origin_ = 0;
    double last_camera_ = 0;
    std::int64_t last_mapped_ = 0;
    double offset_ = 0;  ///< host - camera at the origins
    double drift_ = 0;
    double second_start_ = 0;
    Quickest quickest_;  ///< of the second that runs
    std::array<Quickest, most_seconds> seconds_{};
    std::size_t seconds_seen_ = 0;  ///< the newest is at (seconds_seen_ - 1) % most_seconds
};

}  // namespace disparityd::capture
