// SPDX-License-Identifier: Apache-2.0
#include "pipeline/noise_levels.h"

namespace disparityd::pipeline {

void NoiseLevels::run(const StageFrame& frame, Parallel& /*workers*/) {
    if (frame.discontinuity) {
        switch_.restart();
    }
    const FrameView& view = frame.view;
    const NoiseEstimate estimate = estimate_noise(view.left, view.right, view.disparity, view.confidence);
    switch_.add(estimate);
    {
        const std::lock_guard lock(mutex_);
        levels_[estimated_++ % levels_.size()] = switch_.level();
        newest_ = estimate.blocks > 0 ? std::optional(FrameNoise{estimate.sigma256, view.noise_level}) : newest_;
    }
    estimated_changed_.notify_one();
}

int NoiseLevels::next(bool discontinuity, Heartbeat& heartbeat, const std::atomic<bool>& failed) {
    const std::uint64_t frame = begun_++;
    first_ = discontinuity ? frame : first_;
    if (frame < first_ + lag) {
        return 0;
    }
    std::unique_lock lock(mutex_);
    while (estimated_ <= frame - lag && !failed.load(std::memory_order_relaxed)) {
        heartbeat.beat();
        estimated_changed_.wait_for(lock, heartbeat_interval);
    }
    return levels_[(frame - lag) % levels_.size()];
}

std::optional<FrameNoise> NoiseLevels::newest() const {
    const std::lock_guard lock(mutex_);
    return newest_;
}

}  // namespace disparityd::pipeline
