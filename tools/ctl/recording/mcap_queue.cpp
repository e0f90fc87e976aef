// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/mcap_queue.h"

#include <exception>
#include <optional>
#include <utility>

#include "base/start_thread.h"

namespace disparityd::tools {

McapQueue::McapQueue(Takers takers) : takers_(std::move(takers)), thread_(base::start_thread([this] { run(); })) {}

McapQueue::~McapQueue() {
    end(false);
}

void McapQueue::push(disparity::Frame frame) {
    {
        const std::lock_guard lock(mutex_);
        ++pushed_;
        if (frames_.size() == most_frames) {
            frames_.pop_front();
            ++dropped_;
        }
        frames_.push_back(std::move(frame));
    }
    changed_.notify_one();
}

void McapQueue::push(const std::vector<disparity::SensorSample>& samples) {
    {
        const std::lock_guard lock(mutex_);
        for (const disparity::SensorSample& sample : samples) {
            if (samples_.size() == most_samples) {
                samples_.pop_front();
                ++dropped_samples_;
            }
            samples_.push_back(sample);
        }
    }
    changed_.notify_one();
}

void McapQueue::end(bool with_rest) {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        if (!with_rest) {
            frames_.clear();
            samples_.clear();
        }
    }
    changed_.notify_one();
    if (thread_.joinable()) {
        thread_.join();
    }
}

void McapQueue::finish() {
    end(true);
    check();
}

std::uint64_t McapQueue::kept() const {
    const std::lock_guard lock(mutex_);
    return pushed_ - dropped_;
}

std::uint64_t McapQueue::dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
}

std::uint64_t McapQueue::dropped_samples() const {
    const std::lock_guard lock(mutex_);
    return dropped_samples_;
}

void McapQueue::check() const {
    const std::lock_guard lock(mutex_);
    if (failure_) {
        std::rethrow_exception(failure_);
    }
}

/// Writes samples before frames: they are small, and belong to the time before.
void McapQueue::run() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return ending_ || !frames_.empty() || !samples_.empty(); });
        if (frames_.empty() && samples_.empty()) {
            return;
        }
        const std::deque<disparity::SensorSample> samples = std::exchange(samples_, {});
        std::optional<disparity::Frame> frame;
        if (!frames_.empty()) {
            frame = std::move(frames_.front());
            frames_.pop_front();
        }
        lock.unlock();
        std::exception_ptr failure;
        try {
            for (const disparity::SensorSample& sample : samples) {
                takers_.sample(sample);
            }
            if (frame) {
                takers_.frame(*frame);
            }
        } catch (...) {
            failure = std::current_exception();
        }
        lock.lock();
        if (failure) {
            failure_ = failure;
            return;
        }
    }
}

}  // namespace disparityd::tools
