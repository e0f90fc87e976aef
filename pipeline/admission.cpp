// SPDX-License-Identifier: Apache-2.0
#include "pipeline/admission.h"

#include <algorithm>

namespace disparityd::pipeline {

Admission::Admission(std::size_t stages, std::size_t computing, std::size_t frames, int workers)
    : computing_(computing), one_worker_(workers == 1), durations_(stages), free_(stages) {
    frames_.reserve(frames);
}

void Admission::begins(std::size_t stage, Time now) {
    const std::lock_guard lock(mutex_);
    const auto frame = oldest_of(stage);
    if (frame != frames_.end()) {
        frame->begun = now;
    } else {
        frames_.push_back({stage, now});
    }
}

void Admission::ends(std::size_t stage, Time now) {
    {
        const std::lock_guard lock(mutex_);
        const auto frame = oldest_of(stage);
        constexpr int followed = 8;
        Duration& average = durations_[stage];
        const Duration taken = now - *frame->begun;
        average = average == Duration::zero() ? taken : average + (taken - average) / followed;
        frame->begun.reset();
        if (++frame->stage == durations_.size()) {
            frames_.erase(frame);
        }
    }
    moved_.notify_one();
}

std::vector<Admission::Frame>::iterator Admission::oldest_of(std::size_t stage) {
    return std::find_if(frames_.begin(), frames_.end(), [&](const Frame& each) { return each.stage == stage; });
}

std::optional<Admission::Time> Admission::opens(Time now) const {
    const std::lock_guard lock(mutex_);
    return opens_locked(now);
}

std::optional<Admission::Time> Admission::opens_locked(Time now) const {
    if (one_worker_) {
        const bool free =
            std::all_of(frames_.begin(), frames_.end(), [&](const Frame& frame) { return frame.stage >= computing_; });
        return free ? std::optional(now) : std::nullopt;
    }
    // When each stage has done with the frames in flight, if it takes as long for each as it did before.
    std::fill(free_.begin(), free_.end(), now);
    for (const Frame& frame : frames_) {
        Time at = now;
        for (std::size_t stage = frame.stage; stage < durations_.size(); ++stage) {
            const Time begin = stage == frame.stage && frame.begun ? *frame.begun : std::max(at, free_[stage]);
            at = std::max(now, begin + durations_[stage]);
            free_[stage] = at;
        }
    }
    Time opens = now;
    Duration way{};
    for (std::size_t stage = 0; stage < durations_.size(); ++stage) {
        opens = std::max(opens, free_[stage] - way);
        way += durations_[stage];
    }
    return opens;
}

void Admission::wait(Heartbeat& heartbeat) {
    std::unique_lock lock(mutex_);
    for (;;) {
        heartbeat.beat();
        const Time now = std::chrono::steady_clock::now();
        const std::optional<Time> time = opens_locked(now);
        if (time && *time <= now) {
            return;
        }
        moved_.wait_until(lock, std::min(time.value_or(Time::max()), now + heartbeat_interval));
    }
}

}  // namespace disparityd::pipeline
