// SPDX-License-Identifier: Apache-2.0
#include "bridges/mavlink/bridge.h"

#include <algorithm>
#include <string>

namespace disparityd::mavlink {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds wait_for_scan{100};
/// With the attitude: what the autopilot sends counts as of the time when it is read.
constexpr milliseconds wait_between_attitudes{5};
constexpr milliseconds heartbeat_period{1000};
/// Without a scan for so long this component counts as failed.
constexpr milliseconds silence{1000};

template <typename Unit>
std::int64_t since_start(steady_clock::time_point time) {
    return std::chrono::duration_cast<Unit>(time.time_since_epoch()).count();
}

/// Returns metres with two decimals.
std::string metres(double value) {
    std::string text = std::to_string(value);
    return text.substr(0, text.find('.') + 3);
}

}  // namespace

Bridge::Bridge(const BridgeSettings& settings, ScanSource& source, Link& link, Notes& notes, AttitudeRelay* attitude)
    : settings_(settings),
      source_(source),
      link_(link),
      notes_(notes),
      attitude_(attitude),
      writer_(settings.system_id, settings.component_id),
      limit_(settings.rate) {}

void Bridge::run(const std::atomic<bool>& stop) {
    while (!stop) {
        step();
    }
}

void Bridge::step() {
    relay_attitude();
    link_.forget_old();
    send_heartbeat();
    if (const auto timed = source_.next(attitude_ != nullptr ? wait_between_attitudes : wait_for_scan)) {
        last_came_ = Clock::now();
        note_scan(*timed);
        send_alarms(*timed);
        send_scan(*timed);
    } else {
        note_source();
    }
    if (link_.problem().empty()) {
        notes_.say("link", link_.name() + ": open", Notes::Repeat::never);
    } else {
        notes_.say("link", link_.problem());
    }
}

void Bridge::send_scan(const TimedScan& timed) {
    const auto now = Clock::now();
    const auto age = now - timed.captured;
    if (age > settings_.max_age) {
        notes_.say("scan", "a scan is " + std::to_string(std::chrono::ceil<milliseconds>(age).count()) +
                               " ms old, allowed: " + std::to_string(settings_.max_age.count()) +
                               " ms; it is not sent. A faster method of the daemon or a higher --max-age-ms helps");
        return;
    }
    if (!link_.open() || !limit_.pass(now)) {
        return;
    }
    const Until until{timed.captured + settings_.max_age, settings_.max_age};
    const SectorDistances distances = sector_distances(timed.scan, settings_.limits);
    const auto time_us = static_cast<std::uint64_t>(since_start<std::chrono::microseconds>(timed.captured));
    if (!send_in_time(obstacle_distance(distances, settings_.limits, time_us), until)) {
        return;
    }
    last_scan_ = Clock::now();
    notes_.say("scan", "scans are sent to " + link_.name(), Notes::Repeat::never);
    if (settings_.send_3d) {
        send_3d(timed, static_cast<std::uint32_t>(time_us / 1000));
    }
}

/// Sends the nearest obstacles first, as many as leave before the next scan is due: that one is not to wait behind
/// them.
void Bridge::send_3d(const TimedScan& timed, std::uint32_t time_ms) {
    const Until until{timed.captured + settings_.max_age,
                      std::min<Clock::duration>(settings_.max_age, limit_.period())};
    for (const Message& message : obstacles_3d(timed.scan, settings_.limits, settings_.camera_height_m, time_ms)) {
        if (!send_in_time(message, until)) {
            return;
        }
    }
}

/// Sends a message if it leaves the link in time; returns whether it does.
bool Bridge::send_in_time(const Message& message, const Until& until) {
    const auto needed = link_.time_for(message.payload.size() + around_payload);
    if (needed > until.on_the_line || Clock::now() + needed > until.deadline) {
        notes_.say("speed", link_.name() +
                                ": not all messages leave in time, the rest is not sent; use a faster link, a "
                                "lower --rate, a higher --max-age-ms or no --3d");
        return false;
    }
    return link_.send(writer_.frame(message), until.deadline);
}

void Bridge::send_alarms(const TimedScan& timed) {
    const auto now = Clock::now();
    alarms_.tell(timed.flags, now,
                 [&](const Message& message) { return link_.send(writer_.frame(message), now + wait_for_scan); });
}

void Bridge::send_heartbeat() {
    const auto now = Clock::now();
    const bool fresh = last_scan_ && now - *last_scan_ <= silence;
    const SystemState state = fresh ? SystemState::active : last_scan_ ? SystemState::critical : SystemState::boot;
    if (now < next_heartbeat_ && told_ == state) {
        return;
    }
    if (link_.send(writer_.frame(heartbeat(state)), now + wait_for_scan)) {
        told_ = state;
        next_heartbeat_ = now + heartbeat_period;
    }
}

void Bridge::relay_attitude() {
    if (attitude_ == nullptr) {
        link_.drain();
        return;
    }
    const auto now = Clock::now();
    link_.drain([&](std::span<const std::uint8_t> bytes) { attitude_->take(bytes, now); });
    attitude_->step(now,
                    [&](const Message& message) { return link_.send(writer_.frame(message), now + wait_for_scan); });
    if (const std::string problem = attitude_->problem(now); !problem.empty()) {
        notes_.say("attitude", "attitude: " + problem);
    } else {
        notes_.say("attitude", "the autopilot's attitude is given to the daemon", Notes::Repeat::never);
    }
}

void Bridge::note_source() {
    const auto now = Clock::now();
    if (!source_.problem().empty()) {
        notes_.say("scan", "no scan: " + source_.problem());
    } else if (now - last_came_ > silence) {
        notes_.say("scan",
                   "no scan: the daemon lives, but nothing has come for a second; disparityctl status says why");
    }
}

void Bridge::note_scan(const TimedScan& timed) {
    if (timed.synthetic) {
        notes_.say("synthetic", "the daemon's frames are synthetic: what is sent is not around the vehicle",
                   Notes::Repeat::never);
    }
    const double max_m = settings_.limits.max_cm / 100.0;
    if (timed.scan.max_m < max_m) {
        notes_.say("range",
                   "the scan ends at " + metres(timed.scan.max_m) + " m, --max-distance-m is " + metres(max_m) +
                       ": no sector will be free; raise [scan] max_m of the daemon or lower --max-distance-m",
                   Notes::Repeat::never);
    }
}

}  // namespace disparityd::mavlink
