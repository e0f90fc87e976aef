// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

#include "kernels/matcher.h"
#include "obstacles/given_levels.h"
#include "obstacles/scan_options.h"
#include "proto/disparity.pb.h"

namespace disparityd::daemon {

/// Takes the levels that one client gives for obstacle scans, and knows where scans have theirs from.
class LevelWatch {
public:
    using Time = std::chrono::steady_clock::time_point;

    /// `ground`: of the scan; nothing where there is no scan. `live`: what the source is.
    LevelWatch(std::optional<GroundMode> ground, bool live) : ground_(ground), live_(live) {}

    /// Returns the levels for the scan; null where it is to use none.
    const scan::GivenLevels* given() const { return ground_ == GroundMode::autopilot && live_ ? &given_ : nullptr; }

    /// Takes levels of a client. Throws std::invalid_argument with one line: what, found, allowed. Any thread.
    void take(const v1::GiveLevel& message, std::uint64_t client, Time now);

    /// Takes the record of a scan, when its frame is published. Publish thread; allocates nothing.
    void note(const Plane<const std::uint8_t>& scan, Time now) noexcept;

    /// Returns where the newest scan has its level from; nothing where scans are not to be level. Any thread.
    std::optional<v1::LevelStatus> status(Time now) const;

private:
    const std::optional<GroundMode> ground_;
    const bool live_;
    scan::GivenLevels given_;
    std::atomic<bool> known_{false};         ///< the newest scan was level
    std::atomic<std::int64_t> level_ns_{0};  ///< when the newest one that was level was published; 0: none
    std::mutex mutex_;                       ///< the two below
    std::optional<std::uint64_t> giver_;     ///< the client whose levels are taken
    Time given_at_{};                        ///< when it has given the newest one
};

}  // namespace disparityd::daemon
