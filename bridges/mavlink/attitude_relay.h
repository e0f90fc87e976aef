// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "bridges/mavlink/attitude.h"
#include "bridges/mavlink/frame_reader.h"
#include "bridges/mavlink/level_giver.h"

namespace disparityd::mavlink {

/// Takes the attitude that the autopilot of one system tells to the daemon, and asks for it while none comes. One
/// thread uses it.
class AttitudeRelay {
public:
    using Clock = std::chrono::steady_clock;

    /// `giver` outlives it.
    AttitudeRelay(std::uint8_t system, LevelGiver& giver) : system_(system), giver_(giver), reader_(attitude_kind) {}

    /// Takes what came from the link just now.
    void take(std::span<const std::uint8_t> bytes, Clock::time_point now);

    /// Gives what has come. Without an attitude for a second it asks the autopilot by `send`, once a second.
    void step(Clock::time_point now, const std::function<bool(const Message&)>& send);

    /// Returns one line: what is missing, and what to do; empty when all is well.
    std::string problem(Clock::time_point now) const;

private:
    bool silent(Clock::time_point now) const { return now - came_ > silence; }

    static constexpr std::chrono::seconds silence{1};

    std::uint8_t system_;
    LevelGiver& giver_;
    FrameReader reader_;
    Clock::time_point came_{};  ///< when the newest attitude came
    Clock::time_point next_request_{};
};

}  // namespace disparityd::mavlink
