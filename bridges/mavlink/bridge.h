// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <optional>

#include "bridges/mavlink/alarm_texts.h"
#include "bridges/mavlink/attitude_relay.h"
#include "bridges/mavlink/heartbeat.h"
#include "bridges/mavlink/link.h"
#include "bridges/mavlink/mavlink_frame.h"
#include "bridges/mavlink/obstacle_message.h"
#include "bridges/mavlink/scan_source.h"
#include "bridges/program/notes.h"
#include "bridges/program/rate_limit.h"

namespace disparityd::mavlink {

using bridges::Notes;
using bridges::RateLimit;

/// What the bridge sends, and when it does not.
struct BridgeSettings {
    std::uint8_t system_id = 1;
    std::uint8_t component_id = 196;
    double rate = 15;                            ///< scans per second at most
    std::chrono::milliseconds max_age{300};      ///< an older scan is not sent
    DistanceLimits limits = {};                  ///< of obstacles
    bool send_3d = false;                        ///< OBSTACLE_DISTANCE_3D beside OBSTACLE_DISTANCE
    std::optional<double> camera_height_m = {};  ///< above the ground, for OBSTACLE_DISTANCE_3D
};

/// Sends the scans of a source over a link, and a HEARTBEAT every second; takes the attitude the other way. One thread
/// uses it.
class Bridge {
public:
    using Clock = std::chrono::steady_clock;

    /// All outlive the bridge. Notes get what a person should know. `attitude`: takes what the autopilot sends; null:
    /// that is thrown away.
    Bridge(const BridgeSettings& settings, ScanSource& source, Link& link, Notes& notes,
           AttitudeRelay* attitude = nullptr);

    /// Runs until `stop` is true, which it sees within a tenth of a second while neither side blocks.
    void run(const std::atomic<bool>& stop);

    /// Takes what the autopilot has sent, waits for one scan, at most a tenth of a second, and sends what is to be
    /// sent.
    void step();

private:
    /// Until when a message must have left the link.
    struct Until {
        Clock::time_point deadline;
        Clock::duration on_the_line;  ///< the longest time that it may wait and be sent there
    };

    void send_scan(const TimedScan& timed);
    void send_3d(const TimedScan& timed, std::uint32_t time_ms);
    bool send_in_time(const Message& message, const Until& until);
    void send_alarms(const TimedScan& timed);
    void send_heartbeat();
    void relay_attitude();
    void note_source();
    void note_scan(const TimedScan& timed);

    BridgeSettings settings_;
    ScanSource& source_;
    Link& link_;
    Notes& notes_;
    AttitudeRelay* attitude_;
    FrameWriter writer_;
    AlarmTexts alarms_;
    RateLimit limit_;
    Clock::time_point last_came_ = Clock::now();  ///< when a scan came, sent or not
    std::optional<Clock::time_point> last_scan_;  ///< when one was sent
    std::optional<SystemState> told_;             ///< what the last HEARTBEAT said
    Clock::time_point next_heartbeat_{};
};

}  // namespace disparityd::mavlink
