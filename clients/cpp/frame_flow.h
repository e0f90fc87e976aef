// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace disparity {

/// Decides how many frames may be on their way to a program, and whether one that has come is still fresh.
///
/// A program that keeps up has a frame on order when the daemon publishes it, so that it is sent at once: it orders as
/// it begins to wait, with as many more as its work and the way to the daemon and back need. One that works longer than
/// an interval has none on order while it works, and gets the daemon's newest when it reads. Pure arithmetic: the
/// caller brings the times, in ns. One thread.
class FrameFlow {
public:
    /// What is known of a frame that has come.
    struct Arrival {
        std::uint64_t publish_index = 0;
        std::int64_t captured_ns = 0;    ///< by the daemon's clock, also of a replay
        std::int64_t sent_ns = 0;        ///< by the daemon's clock
        std::int64_t now_ns = 0;         ///< the daemon's clock now, at most
        std::int64_t unwatched_ns = 0;   ///< since the socket was seen empty: it has lain there no longer
        std::int64_t round_trip_ns = 0;  ///< the shortest one known
    };

    /// A subscription begins, here or at a new connection: nothing is on its way. `max_rate` as in Subscription.
    void start(double max_rate);

    /// The program has begun to read.
    void reads(std::int64_t now_ns);
    /// It has been given a frame, and works on it from now on.
    void given(std::int64_t now_ns);

    /// Returns how many frames the daemon may send more, and counts them as asked for. `waiting`: the program waits for
    /// one now.
    std::uint32_t ask(bool waiting);

    /// Counts a frame that has come.
    void arrived(const Arrival& frame);
    /// Returns whether that frame may be given: it has lain no longer than an interval, or it was asked for since the
    /// last one that was not fresh and has come while the program waited.
    bool fresh(const Arrival& frame);

    /// Returns the time from one frame to the next as the program gets them; 0 = not known yet.
    std::int64_t interval_ns() const;

    /// Returns how long a frame that is asked for now may take to come, if the daemon has one.
    std::int64_t patience_ns() const;

private:
    std::uint32_t wanted(bool waiting) const;

    std::int64_t least_interval_ns_ = 0;  ///< of max_rate
    std::int64_t published_ns_ = 0;       ///< between two frames that the daemon publishes; 0 = not known
    std::uint64_t last_index_ = 0;
    std::int64_t last_captured_ns_ = 0;
    bool any_ = false;          ///< last_... are of a frame
    std::int64_t way_ns_ = -1;  ///< from the daemon to here, that of fast frames; negative = not known
    std::int64_t round_trip_ns_ = 0;
    std::int64_t given_ns_ = 0;     ///< when the last frame was given
    std::int64_t work_ns_ = 0;      ///< how long the program worked on the last one
    bool working_ = false;          ///< on a frame that was given
    bool waited_ = false;           ///< the program, since it began to read
    std::uint32_t on_the_way_ = 0;  ///< frames asked for that have not come
    std::uint32_t suspects_ = 0;    ///< of them, those that were asked for before one that was not fresh
    bool refused_ = false;          ///< the last frame was not fresh
};

}  // namespace disparity
