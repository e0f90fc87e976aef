// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace disparityd::capture {

/// Decides what is to be done about a camera, and when. It makes no system calls: its owner does what due() says and
/// reports the result. One thread.
///
/// A stream without frames is recovered in three steps: restart the stream, open the device anew, reset the device on
/// the USB. After the third step the first follows again, and each round waits longer than the one before. Frames for
/// Times::steady end the recovery.
class CameraRecovery {
public:
    using Time = std::chrono::steady_clock::time_point;
    using Duration = std::chrono::steady_clock::duration;

    struct Times {
        Duration silence = std::chrono::milliseconds(1000);      ///< a stream without a frame for so long has stalled
        Duration first_frame = std::chrono::milliseconds(2000);  ///< wait after a start
        Duration retry = std::chrono::milliseconds(250);         ///< between two looks for a camera
        Duration steady = std::chrono::milliseconds(2000);       ///< frames for so long end the recovery
        Duration longest = std::chrono::seconds(10);             ///< longest wait of later rounds
    };

    enum class Step {
        wait,     ///< nothing until next(), or until a frame comes
        open,     ///< look for the camera, open it and start the stream; then started() or absent()
        restart,  ///< stop the stream and start it; then started() or failed()
        reopen,   ///< close the device; then reopen_at_once()
        reset,    ///< reset the device on the USB, close it; then absent()
    };

    CameraRecovery(const Times& times, Time now) : times_(times), retry_at_(now) {}

    /// Returns what has to be done now. Each step of the recovery is returned once.
    Step due(Time now) {
        if (!running_) {
            return now >= retry_at_ ? Step::open : Step::wait;
        }
        return now >= next() ? next_step() : Step::wait;
    }

    /// Returns when due() will say something new if nothing happens meanwhile.
    Time next() const {
        if (!running_) {
            return retry_at_;
        }
        if (failed_) {
            return started_ + (rounds_ == 0 ? Duration::zero() : first_frame_wait());
        }
        return frames_ ? last_frame_ + times_.silence : started_ + first_frame_wait();
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
            step_ = 0;
            rounds_ = 0;
        }
    }

    /// The device reports an error: the next step follows at once.
    void failed() {
        running_ = true;
        failed_ = true;
    }

    /// There is no camera, or none that can be used: look for one again after Times::retry.
    void absent(Time now) {
        running_ = false;
        retry_at_ = now + times_.retry;
    }
    void reopen_at_once(Time now) {
        running_ = false;
        retry_at_ = now;
    }

    /// The camera was plugged in again: steps tried before do not count.
    void forget_attempts() {
        step_ = 0;
        rounds_ = 0;
    }

private:
    /// Returns how long to wait for a frame after a start: twice as long in each round.
    Duration first_frame_wait() const {
        Duration wait = times_.first_frame;
        for (int round = 0; round < rounds_ && wait < times_.longest; ++round) {
            wait *= 2;
        }
        return wait < times_.longest ? wait : times_.longest;
    }

    Step next_step() {
        constexpr Step steps[] = {Step::restart, Step::reopen, Step::reset};
        const Step step = steps[step_];
        step_ = (step_ + 1) % 3;
        rounds_ += step_ == 0 ? 1 : 0;
        return step;
    }

    const Times times_;
    bool running_ = false;
    bool failed_ = false;
    bool frames_ = false;
    int step_ = 0;    ///< of the round, the next to be done
    int rounds_ = 0;  ///< since the last recovery
    Time retry_at_;
    Time started_{};
    Time first_frame_{};
    Time last_frame_{};
};

}  // namespace disparityd::capture
