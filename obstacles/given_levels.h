// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>

namespace disparityd::scan {

/// Where up is, along the robot's axes ahead, left and up; of length 1.
struct RobotUp {
    double ahead = 0;
    double left = 0;
    double up = 1;

    friend bool operator==(const RobotUp&, const RobotUp&) = default;
};

/// Returns the direction with length 1; nothing where a number is none or the length is more than 0.1 away from 1.
std::optional<RobotUp> checked_up(const RobotUp& up);

/// Keeps where up was in the last moments, as an autopilot tells it. Any thread may call any function; allocates
/// nothing.
class GivenLevels {
public:
    /// A level is used for frames that are at most so far away from it.
    static constexpr std::int64_t fresh_ns = 200'000'000;

    /// Keeps where up was at that time, CLOCK_MONOTONIC. One that is not later than the newest is left out.
    void add(std::int64_t monotonic_ns, const RobotUp& up);

    /// Returns where up was at the time: between the levels before and after it, or as the only one of them says that
    /// is fresh. Returns nothing where none is.
    std::optional<RobotUp> up_at(std::int64_t monotonic_ns) const;

    /// Returns the time of the newest level; nothing before the first one.
    std::optional<std::int64_t> newest_ns() const;

private:
    struct Level {
        std::int64_t monotonic_ns = 0;
        RobotUp up;
    };

    /// Holds more than half a second of the fastest autopilots.
    static constexpr std::size_t most = 256;

    /// The i-th oldest, with mutex_ held.
    const Level& at(std::size_t i) const { return levels_[(begin_ + i) % most]; }

    mutable std::mutex mutex_;
    std::array<Level, most> levels_{};
    std::size_t begin_ = 0;
    std::size_t count_ = 0;
};

}  // namespace disparityd::scan
