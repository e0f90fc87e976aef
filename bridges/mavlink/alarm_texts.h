// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>

#include "bridges/mavlink/mavlink_frame.h"
#include "proto/doubt.h"

namespace disparityd::mavlink {

inline constexpr MessageKind status_text_kind{253, 83, 54};

/// The severity of a STATUSTEXT: values of MAV_SEVERITY.
enum class Severity : std::uint8_t { warning = 4, info = 6 };

/// Returns a STATUSTEXT; of the text the first 50 characters are sent.
Message status_text(Severity severity, std::string_view text);

/// Tells people at the ground station which alarms begin and end: a dirty eye, for example. One thread uses it.
class AlarmTexts {
public:
    using Clock = std::chrono::steady_clock;

    /// Between two texts about one alarm.
    static constexpr std::chrono::seconds pause{5};

    /// Takes the flags of a frame, with its doubts, and calls `send` for each alarm that has begun or ended. Where it
    /// returns false, the text is due again with the next frame.
    void tell(std::uint32_t flags, Clock::time_point now, const std::function<bool(const Message&)>& send);

private:
    struct Told {
        bool holds = false;
        Clock::time_point when{};
    };

    std::array<Told, proto::doubts.size()> told_;
};

}  // namespace disparityd::mavlink
