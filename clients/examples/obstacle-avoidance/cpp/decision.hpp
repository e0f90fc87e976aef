// SPDX-License-Identifier: Apache-2.0
//
// Decides how fast a robot may drive straight ahead, from obstacle scans and from what is missing. Reads no clock and
// does no I/O: the caller says what came and when. python/decision.py is the same in Python.
//
// Lengths are metres, times seconds, angles degrees, speeds m/s. Distances count from the origin of the scan,
// which is in the middle of the robot's width.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <disparity_client.hpp>

namespace avoid {

/// Describes the robot, and how careful it is.
struct Options {
    double width_m = 0.5;            ///< of the corridor: the robot's width with some room on both sides
    double margin_m = 0.5;           ///< the robot stands still this far before an obstacle
    double smallest_m = 0.1;         ///< width of the smallest obstacle that may hide where nothing is known
    double speed_mps = 1.0;          ///< on a free way
    double deceleration_mps2 = 1.0;  ///< of a full brake
    double reaction_s = 0.2;         ///< from a decision until the brakes work
    double max_age_s = 0.25;         ///< an older frame is danger
    int good_frames = 3;             ///< so many in a row end a brake
    double camera_height_m = 0;      ///< above the floor, as [scan] has it; 0: any
    double camera_pitch_deg = 0;     ///< the same, where the height is told; positive looks down
    bool synthetic = false;          ///< frames that no camera saw count, too: for tests
};

/// Below this speed the robot stands still.
inline constexpr double least_speed_mps = 0.05;

/// Trust in a frame, 1 .. 255: below the first the robot brakes, from the second on it may drive at full speed. Of a
/// sector: below the first it is unknown, from the second on all counts that it says, from the third on with a doubt.
inline constexpr std::uint32_t least_trust = 30;
inline constexpr std::uint32_t full_trust = 150;
inline constexpr std::uint32_t full_trust_in_doubt = 255;

/// The floor contradicts a mounting that is off by more: the daemon's own limits.
inline constexpr double other_height_m = 0.08;
inline constexpr double other_height_share = 0.15;
inline constexpr double other_pitch_deg = 6;

enum class State { drive, slow, brake };

/// Edges of sectors have steps of 0.01 degrees: those that are nearer than this are the same.
inline constexpr double edge_step_deg = 0.005;

/// Why the robot brakes. A change of it is worth a line.
enum class Cause { start, daemon, age, frame, gap, trust, mounting, view, stop };

struct Decision {
    State state = State::brake;
    double speed_mps = 0;  ///< the robot may drive this fast now
    Cause cause = Cause::start;
    std::string reason = "no frame yet";
    double ahead_m = std::numeric_limits<double>::quiet_NaN();  ///< the way is free so far; NaN: not known
};

inline const char* name_of(State state) {
    return state == State::drive ? "DRIVE" : state == State::slow ? "SLOW" : "BRAKE";
}

/// Formats a number as printf() does; Python prints the same.
inline std::string text(const char* format, double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
}

/// Returns the line that people read.
inline std::string line_of(const Decision& decision) {
    const std::string speed = decision.state == State::brake ? "" : text("%.2f m/s, ", decision.speed_mps);
    return std::string(name_of(decision.state)) + ' ' + speed + decision.reason;
}

/// Says what limits the way ahead.
struct Limit {
    double ahead_m = std::numeric_limits<double>::infinity();  ///< along the robot's x axis
    std::string reason;
};

inline std::string at_bearing(double bearing_deg) {
    return ", bearing " + std::to_string(static_cast<int>(std::floor(bearing_deg + 0.5))) + " deg";
}

/// Says why something is trusted no more: "trust in the frame is 75 of 255: misaligned".
inline std::string trust_text(const std::string& what, std::uint32_t trust, std::uint32_t doubts) {
    const std::string names = disparity::doubt_names(doubts);
    return what + " is " + std::to_string(trust) + " of 255" + (names.empty() ? "" : ": ") + names;
}

/// `obstacle`: the sector shows one that is in the corridor.
inline std::string what_limits(const disparity::ScanSector& sector, bool obstacle) {
    if (sector.is_near()) {
        return "obstacle at most " + text("%.2f m away", sector.distance_m);
    }
    if (sector.trust != 0) {
        return trust_text("trust in the way", sector.trust, sector.doubts);  // trusted() leaves trust where it is short
    }
    return obstacle && sector.free_m >= sector.distance_m ? "obstacle at " + text("%.2f m", sector.distance_m)
                                                          : "unknown beyond " + text("%.2f m", sector.free_m);
}

/// Returns how far the corridor is free in the bearings of a sector; nothing where the sector does not limit it.
///
/// At the bearing b a ray leaves the corridor at the distance width / 2 / sin |b|. What is farther away does not
/// matter, and the edge nearer to the axis decides for the sector. Something may be at the distance free_m, anywhere in
/// the part of the sector that lies in the corridor there; the bearing farthest from the axis brings it nearest.
///
/// A sector whose part of the corridor lies within the margin counts only where it shows an obstacle: a camera sees
/// little so near to its side. What is there now was ahead before.
inline std::optional<Limit> limit_of(const disparity::ScanSector& sector, const Options& options) {
    constexpr double radians = std::numbers::pi / 180;
    const double half = options.width_m / 2;
    const double from = std::max(sector.from_deg, -90.0) * radians;
    const double to = std::min(sector.to_deg, 90.0) * radians;
    if (from >= to) {
        return std::nullopt;  // behind
    }
    const bool ahead = from <= 0 && to >= 0;
    const double inner = std::min(std::abs(from), std::abs(to));
    const double outer = std::max(std::abs(from), std::abs(to));
    const double infinity = std::numeric_limits<double>::infinity();
    const double reach = ahead ? infinity : half / std::sin(inner);
    if (sector.free_m >= reach) {
        return std::nullopt;
    }
    const bool obstacle = sector.state == disparity::SectorState::occupied && sector.distance_m < reach;
    const double exit = ahead ? infinity : half / std::tan(inner);
    if (!obstacle && exit <= options.margin_m) {
        return std::nullopt;
    }
    const double widest = sector.free_m > half ? std::asin(half / sector.free_m) : std::numbers::pi / 2;
    Limit limit;
    limit.ahead_m = sector.free_m * std::cos(std::min(outer, widest));
    limit.reason = what_limits(sector, obstacle) + at_bearing((sector.from_deg + sector.to_deg) / 2);
    return limit;
}

/// What trust in its sectors does to a scan.
enum class Trusting { stop, slow };

/// Returns how much of the room beyond the margin counts in a sector: all of it where its trust is not told or full.
inline double trusted_share(const disparity::ScanSector& sector, Trusting trusting) {
    if (sector.trust == 0) {
        return 1;
    }
    if (sector.trust < least_trust || trusting == Trusting::stop) {
        return sector.trust < least_trust ? 0 : 1;
    }
    const double full = sector.doubts == 0 ? full_trust : full_trust_in_doubt;
    return std::min(1.0, sector.trust / full);
}

/// Returns the scan with free_m of each sector as far as it is believed, the rule for sectors in doubt: with less than
/// least_trust a sector is unknown, so that the robot stops before it as before all that is unknown. With more, only
/// a share of the room beyond the margin counts (Trusting::slow): the robot becomes slower, and never stands for that
/// alone. Trust is left in those sectors only that lose something by it.
inline disparity::Scan trusted(disparity::Scan scan, const Options& options, Trusting trusting) {
    for (disparity::ScanSector& sector : scan.sectors) {
        const double share = trusted_share(sector, trusting);
        if (share == 0) {
            sector.free_m = 0;
        } else if (share < 1) {
            sector.free_m = std::min(sector.free_m, options.margin_m + share * (sector.free_m - options.margin_m));
        } else {
            sector.trust = 0;
        }
    }
    return scan;
}

/// Returns how far nothing hides in a sector, which is farther than its free_m where its neighbours know more: beside
/// each thing is a strip that one eye does not see, too narrow for an obstacle nearby. Unknown sectors in a row hide an
/// obstacle from the distance on at which it is as wide as they are together. What lies beyond the scan's sectors is
/// unknown, and beside what is too near to be measured nothing is narrow.
inline double hidden_from(const std::vector<disparity::ScanSector>& sectors, std::size_t sector,
                          const Options& options) {
    const disparity::ScanSector& own = sectors[sector];
    const double most =
        own.state == disparity::SectorState::occupied ? own.distance_m : std::numeric_limits<double>::infinity();
    double free = own.free_m;
    if (own.is_near() || options.smallest_m <= 0) {
        return free;
    }
    std::size_t first = sector;
    std::size_t last = sector;
    while (free < most) {
        if (first == 0 || last + 1 == sectors.size()) {
            return free;
        }
        const disparity::ScanSector& right = sectors[first - 1];
        const disparity::ScanSector& left = sectors[last + 1];
        if (right.to_deg < sectors[first].from_deg - edge_step_deg || left.is_near() || right.is_near() ||
            left.from_deg > sectors[last].to_deg + edge_step_deg) {
            return free;
        }
        const double wide = (sectors[last].to_deg - sectors[first].from_deg) * std::numbers::pi / 180;
        const double next = std::min(right.free_m, left.free_m);
        if (options.smallest_m <= wide * std::max(free, next)) {
            return std::min(most, std::max(free, options.smallest_m / wide));
        }
        free = std::max(free, next);
        first -= right.free_m <= free ? 1 : 0;
        last += left.free_m <= free ? 1 : 0;
    }
    return std::min(free, std::max(own.free_m, most));
}

/// Returns the scan with free_m of each sector up to where something may hide.
inline disparity::Scan without_narrow_gaps(const disparity::Scan& scan, const Options& options) {
    disparity::Scan wider = scan;
    for (std::size_t i = 0; i < scan.sectors.size(); ++i) {
        wider.sectors[i].free_m = hidden_from(scan.sectors, i, options);
    }
    return wider;
}

/// Returns the first bearing of the corridor that no sector covers, from the margin on; nothing when all are covered.
inline std::optional<double> uncovered(const disparity::Scan& scan, const Options& options) {
    const double end = std::atan2(options.width_m / 2, options.margin_m) * 180 / std::numbers::pi;
    double covered = -end;
    for (const disparity::ScanSector& sector : scan.sectors) {
        if (sector.from_deg <= covered + edge_step_deg && sector.to_deg > covered) {
            covered = sector.to_deg;
        }
    }
    return covered < end ? std::optional(covered) : std::nullopt;
}

/// Returns what limits the corridor. Sectors that are not there limit it at 0.
inline Limit way_ahead(const disparity::Scan& scan, const Options& options, Trusting trusting = Trusting::stop) {
    if (const auto bearing = uncovered(scan, options)) {
        return {0, "no sector" + at_bearing(*bearing)};
    }
    Limit nearest;
    for (const disparity::ScanSector& sector : without_narrow_gaps(trusted(scan, options, trusting), options).sectors) {
        const auto limit = limit_of(sector, options);
        if (limit && limit->ahead_m < nearest.ahead_m) {
            nearest = *limit;
        }
    }
    return nearest;
}

/// Returns the time that passes before the brakes work: what a frame shows may be as old as the limit.
inline double delay_s(const Options& options) {
    return options.reaction_s + options.max_age_s;
}

/// Returns the way that the robot needs to stop.
inline double stopping_distance(double speed_mps, const Options& options) {
    return speed_mps * delay_s(options) + speed_mps * speed_mps / (2 * options.deceleration_mps2);
}

/// Returns the speed from which the robot stops within `room_m` with half of its deceleration, at most that on a free
/// way. The other half is what a full brake has left for what appears suddenly.
inline double speed_for(double room_m, const Options& options) {
    const double deceleration = options.deceleration_mps2 / 2;
    const double delay = delay_s(options);
    const double speed = deceleration * (std::sqrt(delay * delay + 2 * std::max(0.0, room_m) / deceleration) - delay);
    return std::min(speed, options.speed_mps);
}

/// Says how fast trust lets the robot drive, and why no faster.
struct TrustLimit {
    double speed_mps = std::numeric_limits<double>::infinity();  ///< 0: it must stand
    std::string reason;
};

/// Returns the limit of a frame of these flags. A daemon that tells no trust limits nothing.
inline TrustLimit trust_limit(std::uint32_t flags, const Options& options) {
    const std::uint32_t trust = disparity::trust_of(flags);
    if (trust == 0 || trust >= full_trust) {
        return {};
    }
    TrustLimit limit;
    limit.speed_mps = trust < least_trust ? 0 : options.speed_mps * trust / full_trust;
    limit.reason = trust_text("trust in the frame", trust, flags);
    return limit;
}

/// Returns the limit of the sectors in the way: the speed for that part of the way which they are trusted for.
inline TrustLimit trust_limit(const disparity::Scan& scan, const Options& options) {
    const Limit way = way_ahead(scan, options, Trusting::slow);
    return {std::max(least_speed_mps, speed_for(way.ahead_m - options.margin_m, options)), way.reason};
}

/// Returns what the floor that the camera sees says against the mounting that is told; nothing where it agrees, or was
/// not found. A scan of a wrong mounting has wrong distances.
inline std::optional<std::string> contradiction(const disparity::Scan& scan, const Options& options) {
    if (!scan.mounting || options.camera_height_m <= 0) {
        return std::nullopt;
    }
    const double height_off = std::abs(scan.mounting->height_m - options.camera_height_m);
    const double pitch_off = std::abs(scan.mounting->pitch_deg - options.camera_pitch_deg);
    if (height_off <= std::max(other_height_m, other_height_share * options.camera_height_m) &&
        pitch_off <= other_pitch_deg) {
        return std::nullopt;
    }
    return "the floor shows a camera " + text("%.2f m", scan.mounting->height_m) + " above it, pitch " +
           text("%.1f deg", scan.mounting->pitch_deg) + "; told are " + text("%.2f m", options.camera_height_m) + ", " +
           text("%.1f deg", options.camera_pitch_deg);
}

/// What the decision takes from a frame.
struct FrameFacts {
    double age_s = 0;                       ///< when it was read, the network included
    std::uint32_t flags = 0;                ///< disparity::FrameFlags
    const disparity::Scan* scan = nullptr;  ///< none: the frame has no scan
};

/// Three states: drive, slow, brake. One bad event brakes; several good frames in a row end a brake. `now_s` is of a
/// steady clock.
class Decider {
public:
    explicit Decider(const Options& options) : options_(options) {}

    const Decision& decision() const { return decision_; }

    /// Returns how long the caller may wait for the next frame before it calls wait().
    double patience_s(double now_s) const {
        return decision_.state == State::brake ? options_.max_age_s
                                               : std::max(0.0, options_.max_age_s - newest_age_s(now_s));
    }

    /// A frame has arrived.
    const Decision& see(const FrameFacts& frame, double now_s) {
        if (has_frame_) {
            wait(now_s);  // the frame before may have become too old while nobody asked
        }
        has_frame_ = true;
        age_s_ = frame.age_s;
        arrived_s_ = now_s;
        if (!(frame.age_s >= 0)) {
            return brake(Cause::frame, "frame has a negative age");
        }
        if (frame.age_s > options_.max_age_s) {
            return too_old(now_s);
        }
        if ((frame.flags & disparity::synthetic) != 0 && !options_.synthetic) {
            return brake(Cause::frame, "frame is synthetic: no camera saw it; --synthetic accepts it");
        }
        if (frame.scan == nullptr) {
            return brake(Cause::frame, "no scan: set enabled = true in [scan] of the daemon's configuration");
        }
        if ((frame.flags & disparity::discontinuity) != 0) {
            return brake(Cause::gap, "gap in the frames: the source was interrupted");
        }
        if (const auto wrong = contradiction(*frame.scan, options_)) {
            return brake(Cause::mounting, *wrong);
        }
        const TrustLimit trust = trust_limit(frame.flags, options_);
        if (trust.speed_mps < least_speed_mps) {
            return brake(Cause::trust, trust.reason);
        }
        const TrustLimit in_way = trust_limit(*frame.scan, options_);
        return judge(way_ahead(*frame.scan, options_), in_way.speed_mps < trust.speed_mps ? in_way : trust);
    }

    /// No frame has arrived for a while.
    const Decision& wait(double now_s) {
        return has_frame_ && newest_age_s(now_s) > options_.max_age_s ? too_old(now_s) : decision_;
    }

    /// There is no daemon.
    const Decision& gone(const std::string& why) { return brake(Cause::daemon, "no daemon: " + why); }

    /// The daemon refuses, or sends what cannot be read.
    const Decision& fail(const std::string& why) { return brake(Cause::frame, "no scan: " + why); }

    /// The program ends.
    const Decision& stop() { return brake(Cause::stop, "stopped by a signal"); }

private:
    double newest_age_s(double now_s) const { return age_s_ + (now_s - arrived_s_); }

    const Decision& too_old(double now_s) {
        return brake(Cause::age, "frame is " + text("%.0f ms old", newest_age_s(now_s) * 1000));
    }

    const Decision& brake(Cause cause, const std::string& reason) {
        good_ = 0;
        decision_ = Decision();
        decision_.cause = cause;
        decision_.reason = reason;
        return decision_;
    }

    /// Judges a frame that can be trusted so far. Brakes when the robot cannot stop before the limit at the speed that
    /// it was allowed.
    const Decision& judge(const Limit& limit, const TrustLimit& trust) {
        const double room = limit.ahead_m - options_.margin_m;
        const double speed_of_way = speed_for(room, options_);
        const double speed = std::min(speed_of_way, trust.speed_mps);
        if (speed < least_speed_mps || room < stopping_distance(decision_.speed_mps, options_)) {
            brake(Cause::view, limit.reason);
            decision_.ahead_m = limit.ahead_m;
            return decision_;
        }
        decision_.ahead_m = limit.ahead_m;
        if (decision_.state == State::brake && ++good_ < options_.good_frames) {
            return decision_;
        }
        const bool full = speed >= options_.speed_mps;
        decision_.state = full ? State::drive : State::slow;
        decision_.speed_mps = speed;
        decision_.reason = full                   ? "free up to " + text("%.1f m", limit.ahead_m)
                           : speed < speed_of_way ? trust.reason
                                                  : limit.reason;
        return decision_;
    }

    Options options_;
    Decision decision_;
    bool has_frame_ = false;
    double age_s_ = 0;      ///< of the newest frame when it arrived
    double arrived_s_ = 0;  ///< when that was
    int good_ = 0;          ///< good frames in a row since the brake began
};

/// Returns whether `now` is worth a line after `before`.
inline bool is_change(const Decision& before, const Decision& now) {
    return now.state != before.state || (now.state == State::brake && now.cause != before.cause);
}

}  // namespace avoid
