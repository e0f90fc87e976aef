// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <mutex>

namespace disparityd::pipeline {

/// Returns the processor time that all threads of this process have used.
std::chrono::nanoseconds processor_time();

/// Keeps a process within so many cores of processor time on average: it lets only so many of the frames that come
/// begin, evenly spread, as the processor time per frame allows that was measured before. All that the process does
/// counts, not matching alone.
///
/// A frame is charged when it begins, at the average of those before it, since its time is spent later. Each second
/// what was charged is compared with what was spent: an excess is saved over the next seconds, by at most half of what
/// they have, so that frames come more rarely then but do not stop. Nothing is saved up while fewer frames come than
/// are allowed. Where the rest of the process alone takes more than the budget, a frame begins now and then all the
/// same (`most_of_frame`), and they are as many as before some seconds after that work has ended.
///
/// admits() and to_wait() are for one thread, the rest for any. Allocates nothing after the constructor.
class CoreBudget {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Seconds = std::chrono::duration<double>;

    /// Over this time the average is told, and is at most the budget once the work is the same for so long.
    static constexpr std::chrono::seconds window{10};

    /// No frame is charged more than the budget of so long, so that one begins at least each 2 * most_of_frame,
    /// whatever else the process does. The budget is kept where a frame costs at most that; frames alone that cost up
    /// to twice as much keep it, too.
    static constexpr std::chrono::seconds most_of_frame{2};

    /// A moment, and the processor time that the process had used by then.
    struct Moment {
        Time time;
        Seconds used;
    };
    using Clock = std::function<Moment()>;

    /// `cores`: above 0. `clock`: what tells the time; empty: that of the system for this process.
    explicit CoreBudget(double cores, Clock clock = {});

    double cores() const { return cores_; }

    /// Returns whether a frame may begin now, and charges it then.
    bool admits();

    /// Returns how long to wait before a frame may begin, as far as is known; at least 0.
    Seconds to_wait() const;

    /// Returns how many cores the process has used on average over the last `window`, or since the first frame.
    double used() const;

private:
    void look_at(const Moment& now);
    void close_second(const Moment& now);
    void begin_second(const Moment& now);
    double next_cost(double of_frame) const;

    static constexpr std::size_t kept = 11;  ///< moments a second apart reach back a window

    const double cores_;
    const Clock clock_;
    // Seconds of processor time, of the thread that admits.
    double cost_ = 0;     ///< of a frame, with its share of all else; 0 = not known yet
    double credit_ = 0;   ///< which a frame costs
    double excess_ = 0;   ///< spent and not charged: still to be saved
    double charged_ = 0;  ///< this and the next two since `second_`
    double unused_ = 0;   ///< credit that was too much to keep
    int admitted_ = 0;    ///< frames
    Moment second_{};     ///< when the second began that is compared next
    Time last_{};         ///< when credit was added; that of the first frame before
    bool begun_ = false;
    mutable std::mutex mutex_;  ///< the two below
    std::array<Moment, kept> moments_{};
    std::size_t count_ = 0;
};

}  // namespace disparityd::pipeline
