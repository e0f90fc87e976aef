// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernels/image.h"
#include "proto/disparity.pb.h"
#include "proto/doubt.h"

namespace disparityd::daemon {

/// Knows how far the newest frame and the sectors of its scan can be trusted, and tells when an alarm begins and ends:
/// what somebody must mend.
class TrustWatch {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// Takes the flags of a frame, with its doubts and trust. Publish thread; allocates nothing.
    void note(std::uint32_t flags) noexcept { newest_.store(flags, std::memory_order_relaxed); }

    /// Takes the record of the frame's scan; one without data changes nothing. Publish thread; allocates nothing.
    void note_scan(const Plane<const std::uint8_t>& scan) noexcept;

    /// Returns a line for people for each alarm that has begun or ended since the last call. One thread, now and then.
    std::vector<std::string> check(Time now);

    struct Finding {
        double ratio = 0;                      ///< 0 .. 1
        std::vector<std::string_view> doubts;  ///< names
        std::string alarm;                     ///< one line for people; empty: none
    };

    /// Returns what is said of the newest frame, and of the alarms that check() has seen; nothing before the first
    /// frame. Any thread.
    std::optional<Finding> finding(Time now) const;

    /// Returns how many sectors of the newest scan are in doubt; nothing before the first one. Any thread.
    std::optional<v1::ScanStatus> scan_status() const;

private:
    /// Sectors of a scan.
    struct Sectors {
        std::uint32_t all = 0;
        std::uint32_t doubted = 0;                               ///< by whatever
        std::array<std::uint32_t, proto::doubts.size()> with{};  ///< by the place in proto::doubts
    };

    std::atomic<std::uint32_t> newest_{0};
    mutable std::mutex mutex_;
    std::array<std::optional<Time>, proto::doubts.size()> since_;  ///< of the alarms that hold
    Sectors sectors_;
};

}  // namespace disparityd::daemon
