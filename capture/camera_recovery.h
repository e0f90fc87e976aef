// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace disparityd::capture {

/// Decides what is to be done about a camera, and when: nothing but rules and times, no system calls. Its owner does
/// what due() says and reports what became of it. One thread.
///
/// A stream that has fallen silent is helped up a ladder: stop and restart it, open the device anew, reset the device
/// on the USB. Whoever has climbed it in vain begins again below, with longer and longer patience. Frames for some time
/// lead back to the ground.
class CameraRecovery {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Duration = std::chrono::steady_clock::duration;

    struct Times {
        Duration silence = std::chrono::milliseconds(1000);      ///< no frame for so long: the stream has stalled
        Duration first_frame = std::chrono::milliseconds(2000);  ///< patience after a start
        Duration retry = std::chrono::milliseconds(250);         ///< between two looks for a camera
        Duration steady = std::chrono::milliseconds(2000);       ///< frames for so long: it has recovered
        Duration longest = std::chrono::seconds(10);             ///< patience after ladders climbed in vain
    };

    enum class Step {
        wait,     ///< nothing until next(), or until a frame comes
        open,     ///< look for the camera, open it and start the stream; then started() or absent()
        restart,  ///< stop the stream and start it; then started() or failed()
        reopen,   ///< close the device; then reopen_at_once()
        reset,    ///< reset the device on the USB, close it; then absent()
    };

    CameraRecovery(const Times& times, Time now) : times_(times), retry_at_(now) {}

    /// What has to be done now. Each rung of the ladder is handed out once.
    Step due(Time now) {
        if (!running_) {
            return now >= retry_at_ ? Step::open : Step::wait;
        }
        return now >= next() ? climb() : Step::wait;
    }

    /// When due() says something new if nothing happens meanwhile.
    Time next() const {
        if (!running_) {
            return retry_at_;
        }
        if (failed_) {
            return started_ + (rounds_ == 0 ? Duration::zero() : patience());
        }
        return frames_ ? last_frame_ + times_.silence : started_ + patience();
    }

    void started(Time now) {
        running_ = true;
        failed_ = false;
        frames_ = false;
        started_ = now;
    }

    void frame(Time now) {
        if (!frames_) {
            frames_ = true;
            first_frame_ = now;
        }
        last_frame_ = now;
        if (now - first_frame_ >= times_.steady) {
            rung_ = 0;
            rounds_ = 0;
        }
    }

    /// The device reports an error: the next rung at once.
    void failed() {
        running_ = true;
        failed_ = true;
    }

    /// There is no camera, or none that can be used: look again later.
    void absent(Time now) {
        running_ = false;
        retry_at_ = now + times_.retry;
    }
    void reopen_at_once(Time now) {
        running_ = false;
        retry_at_ = now;
    }

    /// Another plugging: what was tried before does not count.
    void forget_attempts() {
        rung_ = 0;
        rounds_ = 0;
    }

private:
    Duration patience() const {
        Duration patience = times_.first_frame;
        for (int round = 0; round < rounds_ && patience < times_.longest; ++round) {
            patience *= 2;
        }
        return patience < times_.longest ? patience : times_.longest;
    }

    Step climb() {
        constexpr Step ladder[] = {Step::restart, Step::reopen, Step::reset};
        const Step step = ladder[rung_];
        rung_ = (rung_ + 1) % 3;
        rounds_ += rung_ == 0 ? 1 : 0;
        return step;
    }

    const Times times_;
    bool running_ = false;
    bool failed_ = false;
    bool frames_ = false;
    int rung_ = 0;
    int rounds_ = 0;  ///< whole ladders climbed since it was steady
    Time retry_at_;
    Time started_{};
    Time first_frame_{};
    Time last_frame_{};
};

}  // namespace disparityd::capture
